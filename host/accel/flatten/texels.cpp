#include "accel/flatten/texels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <span>

#include "base/error.h"
#include "base/paged.h"

namespace kdray::flatten {

namespace {

// A chain with mipmaps serves textures without as well, since its first level is the picture.
bool serves(const Chain& chain, const scene::Texture& texture) {
  return chain.picture == texture.picture &&
         (!scene::has_mipmaps(texture.minify) || (chain.mipmaps && chain.curved == texture.curved));
}

std::size_t add_chain(std::vector<Chain>& chains, const scene::Texture& texture) {
  const auto found =
      std::find_if(chains.begin(), chains.end(), [&](const Chain& c) { return serves(c, texture); });
  if (found != chains.end()) return static_cast<std::size_t>(found - chains.begin());
  chains.push_back(
      {.picture = texture.picture, .curved = texture.curved, .mipmaps = scene::has_mipmaps(texture.minify)});
  return chains.size() - 1;
}

void set_levels(const scene::Picture& picture, Chain& chain) {
  const std::vector<scene::LevelSize> sizes = scene::level_sizes(picture.width, picture.height);
  chain.size = sizes.front();
  chain.n_levels = chain.mipmaps ? sizes.size() : 1;
  chain.n_texels = 0;
  for (std::size_t k = 0; k < chain.n_levels; ++k) chain.n_texels += sizes[k].texels();
}

}  // namespace

// Textures with mipmaps come first, so that others find their chains.
TexelPlan plan_texels(const scene::Texturing& texturing) {
  TexelPlan plan;
  plan.chain_of.resize(texturing.textures.size());
  for (const bool mipmaps : {true, false})
    for (std::size_t i = 0; i < texturing.textures.size(); ++i)
      if (scene::has_mipmaps(texturing.textures[i].minify) == mipmaps)
        plan.chain_of[i] = add_chain(plan.chains, texturing.textures[i]);
  plan.n_texels = KDRAY_TEXEL_CURVE;
  for (Chain& chain : plan.chains) {
    set_levels(*texturing.pictures[chain.picture], chain);
    chain.first = plan.n_texels;
    plan.n_texels += chain.n_texels;
  }
  if (plan.n_texels > std::numeric_limits<layout::u32>::max())
    throw Error(ErrorCode::input, "the scene's pictures have over 2^32 texels; make them smaller");
  return plan;
}

Array<layout::u32> pack_texels(const scene::Texturing& texturing, const TexelPlan& plan) {
  Array<layout::u32> texels = paged_array<layout::u32>(plan.n_texels);
  for (layout::u32 code = 0; code < KDRAY_TEXEL_CURVE; ++code)
    texels[code] = scene::linear_unit_of_srgb(code / 255.0);
  tbb::parallel_for(std::size_t{0}, plan.chains.size(), [&](std::size_t i) {
    const Chain& chain = plan.chains[i];
    scene::write_levels(*texturing.pictures[chain.picture], chain.curved, 0, chain.n_levels,
                        std::span(texels.data() + chain.first, chain.n_texels));
  });
  return texels;
}

}  // namespace kdray::flatten
