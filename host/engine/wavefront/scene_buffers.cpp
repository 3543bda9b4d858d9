#include "engine/wavefront/scene_buffers.h"

#include <memory>
#include <mutex>
#include <optional>

#include "accel/flatten/compressed.h"
#include "device/opencl/opencl_error.h"

namespace kdray::wavefront {

namespace {

struct Piece {
  const void* data = nullptr;
  std::size_t bytes = 0;
  std::shared_ptr<void> owner;
};

template <class T>
Piece piece_of(const Array<T>& items) {
  return {items.data(), items.bytes(), items.owner()};
}

// The wide form's nodes, by the name that they have among the scene's arrays.
struct WideNodes {
  const Array<layout::WideNode>& wide_nodes;
};

std::array<Piece, SceneBuffers::Slot::kArrays> pieces_of(const flatten::FlatScene& flat_scene,
                                                         const flatten::WideForm& wide_form) {
  // An array of the list is a member of that name of one of the three.
#define KDRAY_PIECE(access, type, name)                               \
  [](const auto& flat, const auto& wide, const auto& nodes_of_wide) { \
    if constexpr (requires { flat.name; })                            \
      return piece_of(flat.name);                                     \
    else if constexpr (requires { nodes_of_wide.name; })              \
      return piece_of(nodes_of_wide.name);                            \
    else                                                              \
      return piece_of(wide.name);                                     \
  }(flat_scene, wide_form, WideNodes{wide_form.nodes}),
  return {KDRAY_SCENE_ARRAYS(KDRAY_PIECE)};
#undef KDRAY_PIECE
}

// What an array is called in messages: "the scene's triangle_blocks".
#define KDRAY_WORDS(access, type, name) "the scene's " #name,
const char* const kNames[] = {KDRAY_SCENE_ARRAYS(KDRAY_WORDS)};
#undef KDRAY_WORDS

}  // namespace

std::array<cl::Buffer*, SceneBuffers::Slot::kArrays> SceneBuffers::all() {
#define KDRAY_ADDRESS(access, type, name) &name,
  return {KDRAY_SCENE_ARRAYS(KDRAY_ADDRESS)};
#undef KDRAY_ADDRESS
}

// The nodes to compress, and the buffer of those that are.
struct SceneBuffers::Compressed {
  Compressed(const device::Context& on, const Array<layout::WideNode>& all) : context(on), nodes(all) {}

  device::Context context;
  Array<layout::WideNode> nodes;
  std::mutex making;
  std::optional<cl::Buffer> buffer;
};

SceneBuffers::SceneBuffers(const device::Context& context, const flatten::FlatScene& flat,
                           const flatten::WideForm& wide)
    : compressed_(std::make_shared<Compressed>(context, wide.nodes)) {
  const auto pieces = pieces_of(flat, wide);
  const auto buffers = all();
  for (std::size_t i = 0; i < Slot::kArrays; ++i)
    *buffers[i] = context.upload(pieces[i].data, pieces[i].bytes, pieces[i].owner, kNames[i]);
}

const cl::Buffer& SceneBuffers::compressed_nodes() const {
  Compressed& c = *compressed_;
  const std::lock_guard lock(c.making);
  if (!c.buffer) {
    const Array<layout::CompressedNode> nodes = flatten::compressed(c.nodes);
    c.buffer = c.context.upload(nodes.data(), nodes.bytes(), nodes.owner(), "the scene's compressed nodes");
  }
  return *c.buffer;
}

void SceneBuffers::upload_lights(const device::Context& context, const flatten::FlatScene& flat,
                                 bool with_sky) {
  const auto upload = [&](const auto& items, std::size_t slot) {
    return context.upload(items.data(), items.bytes(), items.owner(), kNames[slot]);
  };
  lights = upload(flat.lights, Slot::lights);
  if (with_sky) sky = upload(flat.sky, Slot::sky), sky_colors = upload(flat.sky_colors, Slot::sky_colors);
}

SceneBuffers::SceneBuffers(const device::Context& context, const Sizes& sizes)
    : compressed_(std::make_shared<Compressed>(context, Array<layout::WideNode>())) {
  const auto buffers = all();
  for (std::size_t i = 0; i < Slot::kArrays; ++i)
    *buffers[i] = context.buffer(CL_MEM_READ_ONLY, sizes[i], kNames[i]);
}

SceneBuffers::Sizes SceneBuffers::sizes_of(const flatten::FlatScene& flat, const flatten::WideForm& wide) {
  Sizes sizes;
  const auto pieces = pieces_of(flat, wide);
  for (std::size_t i = 0; i < Slot::kArrays; ++i) sizes[i] = pieces[i].bytes;
  return sizes;
}

void SceneBuffers::copy(cl::CommandQueue& queue, const flatten::FlatScene& flat,
                        const flatten::WideForm& wide) {
  const auto pieces = pieces_of(flat, wide);
  const auto buffers = all();
  device::checked("uploading the scene", [&] {
    for (std::size_t i = 0; i < Slot::kArrays; ++i)
      if (pieces[i].bytes > 0)
        queue.enqueueWriteBuffer(*buffers[i], CL_FALSE, 0, pieces[i].bytes, pieces[i].data);
    queue.finish();
  });
  compressed_ = std::make_shared<Compressed>(compressed_->context, wide.nodes);
}

}  // namespace kdray::wavefront
