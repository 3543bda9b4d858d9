#include "bench/build/builders.h"

#include "accel/prepare/prepared.h"

namespace kdray::bench {

std::vector<Builder> quality_builders(std::size_t n_primitives) {
  std::vector<Builder> builders;
  for (const BuildQuality quality : {BuildQuality::fast, BuildQuality::balanced, BuildQuality::best})
    builders.push_back({std::string(prepare::name_of(quality)),
                        prepare::config_of({.quality = quality, .binary_form = false}, n_primitives)});
  return builders;
}

std::vector<Builder> thesis_builders(std::size_t n_primitives) {
  kdtree::BuildConfig perfect =
      prepare::config_of({.quality = BuildQuality::best, .binary_form = false}, n_primitives);
  perfect.tight_cells = perfect.groups = false;
  kdtree::BuildConfig boxed = perfect, spatial = perfect, object = perfect;
  boxed.clip = false;
  spatial.split_rule = kdtree::SplitRule::spatial_median;
  object.split_rule = kdtree::SplitRule::object_median;
  return {{"perfect", perfect}, {"boxed", boxed}, {"spatial median", spatial}, {"object median", object}};
}

}  // namespace kdray::bench
