#include "engine/odprt/ray_batch.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace kdray::odprt {

namespace {

struct PileHead {
  std::uint32_t part = 0, slice = 0, n_rays = 0, n_shadow_rays = 0;
};

std::uint32_t word(std::span<const float> ray, std::uint32_t field) {
  return std::bit_cast<std::uint32_t>(ray[field]);
}

std::uint32_t copy_rays(const RayPile& pile, std::size_t most_bytes, transport::Bytes& to) {
  const std::size_t n = std::min(pile.size(), most_bytes / (pile.n_fields() * sizeof(float)) + 1);
  const std::span<const float> words = pile.last(n);
  to.append(reinterpret_cast<const char*>(words.data()), words.size_bytes());
  return static_cast<std::uint32_t>(n);
}

// Reads a message from its front.
class Reader {
 public:
  explicit Reader(const transport::Message& message)
      : message_(message), rest_(std::string_view(message.bytes).substr(sizeof(RaysHead))) {}

  PileHead head() {
    PileHead head;
    take(&head, sizeof head);
    return head;
  }
  std::span<const float> words(std::size_t n) {
    if (n > rest_.size() / sizeof(float)) transport::refuse(message_);
    words_.resize(n);
    take(words_.data(), n * sizeof(float));
    return words_;
  }
  bool is_at_end() const { return rest_.empty(); }

 private:
  void take(void* to, std::size_t n) {
    if (n > rest_.size()) transport::refuse(message_);
    if (n > 0) std::memcpy(to, rest_.data(), n);
    rest_.remove_prefix(n);
  }

  const transport::Message& message_;
  std::string_view rest_;
  std::vector<float> words_;
};

bool is_pixel(std::uint32_t pixel, const RaysKnown& known) {
  return pixel >= known.first_pixel && pixel - known.first_pixel < known.n_pixels;
}

bool is_ray(std::span<const float> ray, const RaysKnown& known) {
  const std::uint32_t finder = word(ray, KDRAY_RAY_FINDER), part = KDRAY_FINDER_PART(finder);
  const std::uint32_t depth = KDRAY_FINDER_DEPTH(finder);
  return depth >= 1 && depth <= known.max_depth && (part < known.n_all_parts || part == KDRAY_NO_PART) &&
         is_pixel(word(ray, KDRAY_RAY_PIXEL), known);
}

}  // namespace

transport::Bytes pack_rays(std::uint32_t list, std::uint32_t first_part, std::span<HostRayQueue> host_rays,
                           std::size_t most_bytes, std::span<std::uint32_t> counts) {
  RaysHead head{list, 0};
  transport::Bytes bytes = transport::to_bytes(head);
  const auto used = [&] { return bytes.size() - sizeof head; };
  const std::size_t n_levels = host_rays.empty() ? 0 : counts.size() / host_rays.front().rays.size();
  for (std::uint32_t p = 0; p < host_rays.size(); ++p)
    for (std::uint32_t s = 0; s < host_rays[p].rays.size() && used() < most_bytes; ++s) {
      auto& rays = host_rays[p].rays[s];
      auto& shadow_rays = host_rays[p].shadow_rays[s];
      if (rays.size() + shadow_rays.size() == 0) continue;
      ++head.n_piles;
      PileHead pile{first_part + p, s, 0, 0};
      const std::size_t at = bytes.size(), most = most_bytes - used();
      bytes.append(sizeof pile, '\0');
      pile.n_rays = copy_rays(rays, most, bytes);
      const std::span<const float> sent = rays.last(pile.n_rays);
      for (std::size_t i = 0; i < pile.n_rays; ++i)
        ++counts[s * n_levels +
                 KDRAY_FINDER_DEPTH(word(sent.subspan(i * rays.n_fields()), KDRAY_RAY_FINDER))];
      rays.drop(pile.n_rays);
      if (pile.n_rays == 0 || used() < most_bytes) pile.n_shadow_rays = copy_rays(shadow_rays, most, bytes);
      shadow_rays.drop(pile.n_shadow_rays);
      counts[s * n_levels] += pile.n_shadow_rays;
      host_rays[p].n -= pile.n_rays + pile.n_shadow_rays;
      std::memcpy(&bytes[at], &pile, sizeof pile);
    }
  std::memcpy(bytes.data(), &head, sizeof head);
  return bytes;
}

void unpack_rays(const transport::Message& message, const RaysKnown& known, std::span<HostRayQueue> host_rays,
                 std::span<std::uint32_t> counts) {
  const auto head = transport::head_of<RaysHead>(message);
  const std::size_t n_levels = known.max_depth + 1;
  Reader reader(message);
  for (std::uint32_t i = 0; i < head.n_piles; ++i) {
    const PileHead pile = reader.head();
    if (pile.part - known.first_part >= known.n_parts || pile.slice >= known.n_slices)
      transport::refuse(message);
    HostRayQueue& to = host_rays[pile.part - known.first_part];
    const auto rays = reader.words(std::size_t{pile.n_rays} * known.ray_fields);
    for (std::size_t r = 0; r < pile.n_rays; ++r) {
      const auto ray = rays.subspan(r * known.ray_fields, known.ray_fields);
      if (!is_ray(ray, known)) transport::refuse(message);
      const std::uint32_t depth = KDRAY_FINDER_DEPTH(word(ray, KDRAY_RAY_FINDER));
      ++counts[pile.slice * n_levels + depth];
      to.deepest = std::max(to.deepest, depth);
    }
    to.rays[pile.slice].put_all(rays);
    const auto shadow_rays = reader.words(std::size_t{pile.n_shadow_rays} * KDRAY_TRAVEL_SHADOW_FIELDS);
    for (std::size_t r = 0; r < pile.n_shadow_rays; ++r)
      if (!is_pixel(word(shadow_rays.subspan(r * KDRAY_TRAVEL_SHADOW_FIELDS), KDRAY_SHADOW_PIXEL), known))
        transport::refuse(message);
    to.shadow_rays[pile.slice].put_all(shadow_rays);
    counts[pile.slice * n_levels] += pile.n_shadow_rays;
    to.n += pile.n_rays + pile.n_shadow_rays;
  }
  if (!reader.is_at_end()) transport::refuse(message);
}

}  // namespace kdray::odprt
