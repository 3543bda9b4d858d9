// What    ODPRT's ranks tell each other, as rank 0 and as another rank gets it: the first byte chooses which
//         message.
#include "engine/frame/result.h"
#include "engine/odprt/rank_table.h"
#include "engine/odprt/ray_batch.h"
#include "fuzz/script.h"

namespace {

using namespace kdray;
using transport::Ranks;

const odprt::RaysKnown kKnown{.first_part = 2,
                              .n_parts = 2,
                              .n_all_parts = 5,
                              .n_slices = 3,
                              .ray_fields = KDRAY_TRAVEL_RAY_FIELDS,
                              .max_depth = 4,
                              .first_pixel = 100,
                              .n_pixels = 50};

void take_rays(Ranks& ranks) {
  std::vector<odprt::HostRayQueue> rays(kKnown.n_parts,
                                        odprt::HostRayQueue(kKnown.n_slices, kKnown.ray_fields));
  std::vector<std::uint32_t> counts(kKnown.n_counts());
  odprt::unpack_rays(ranks.wait(transport::kTagsOfRays), kKnown, rays, counts);
  std::uint64_t n = 0, counted = 0;
  for (const odprt::HostRayQueue& queue : rays) n += queue.n;
  for (const std::uint32_t count : counts) counted += count;
  if (n != counted) fuzz::fail("rays that are not counted");
}

void take_list(Ranks& ranks) {
  while (const auto list = odprt::next_list(ranks))
    if (list->entries.size() != list->head.n_entries) fuzz::fail("a list of another length");
}

void take_sums(Ranks& ranks) {
  std::vector<layout::i64> sums(3 * 20);
  std::vector<layout::u32> left;
  odprt::gather_sums(ranks, 1, sums, left);
}

void take_share(Ranks& ranks) {
  const transport::Message message = ranks.wait(transport::kTagsOfLists);
  transport::Reader reader(message);
  frame::Result result;
  frame::QueueReport queue;
  frame::add_share(reader, result);
  frame::pass_queue(reader, queue);
}

}  // namespace

KDRAY_FUZZ(odprt, bytes) {
  using namespace transport;
  fuzz::Input input(bytes);
  const auto which = input.take<std::uint8_t>();
  switch (which % 7) {
    case 0:
      return fuzz::plays(1, 3, input.rest(), kTagsOfRays, take_rays);
    case 1:
      return fuzz::plays(1, 3, input.rest(), kTagsOfLists, take_list);
    case 2:
      return fuzz::plays(0, 3, input.rest(), kTagsOfLists, take_sums);
    case 3:
      return fuzz::plays(0, 3, input.rest(), kTagsOfLists, take_share);
    case 4:
      return fuzz::plays(1, 3, input.rest(), kTagsOfDivisions,
                         [](Ranks& ranks) { odprt::share_division(ranks, {}); });
    default:
      return fuzz::plays(which % 7 - 5, 3, input.rest(), kTagsOfJoining,
                         [](Ranks& ranks) { odprt::join(ranks, 2, 4); });
  }
}
