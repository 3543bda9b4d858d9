#include "engine/odprt/rank_table.h"

#include <algorithm>

#include "cluster/transport/message_bytes.h"

namespace kdray::odprt {

namespace {

constexpr transport::Tag kJoin = transport::kTagsOfJoining.first, kTable = kJoin + 1;
constexpr std::uint32_t kMostQueues = 1 << 16;  // of a rank

struct JoinHead {
  std::uint32_t n_queues = 0, n_slices = 0;
};

}  // namespace

Joined join(transport::Ranks& ranks, std::size_t n_queues, std::uint32_t n_slices) {
  const auto size = static_cast<std::size_t>(ranks.size());
  std::vector<std::uint32_t> counts(size);
  JoinHead head{static_cast<std::uint32_t>(n_queues), n_slices};
  if (ranks.leads()) {
    counts.front() = head.n_queues;
    for (std::size_t i = 1; i < size; ++i) {
      const transport::Message message = ranks.wait(transport::kTagsOfJoining);
      std::uint32_t& count = counts[static_cast<std::size_t>(message.from)];
      const auto joins = transport::head_of<JoinHead>(message);
      if (message.tag != kJoin || count != 0 || joins.n_queues == 0 || joins.n_queues > kMostQueues ||
          joins.n_slices == 0 || joins.n_slices > kMostQueues)
        transport::refuse(message);
      count = joins.n_queues;
      head.n_slices = std::max(head.n_slices, joins.n_slices);
    }
    ranks.send_to_others(kTable, transport::to_bytes(head, counts));
  } else {
    ranks.send(0, kJoin, transport::to_bytes(head));
    const transport::Message message = ranks.wait(transport::kTagsOfJoining);
    head = transport::head_of<JoinHead>(message);
    counts = transport::words_behind<JoinHead>(message);
    if (message.from != 0 || message.tag != kTable || counts.size() != size ||
        counts[static_cast<std::size_t>(ranks.rank())] != n_queues || head.n_slices > kMostQueues)
      transport::refuse(message);
  }
  Joined joined{{&ranks, {0}}, head.n_slices};
  for (const std::uint32_t n : counts) joined.table.first.push_back(joined.table.first.back() + n);
  return joined;
}

}  // namespace kdray::odprt
