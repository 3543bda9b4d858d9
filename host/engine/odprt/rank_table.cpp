#include "engine/odprt/rank_table.h"

#include <utility>

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

namespace {

using transport::head_of, transport::refuse, transport::to_bytes;

constexpr std::size_t kMostSumBytes = std::size_t{1} << 20;  // of a message of sums, about

struct DivisionHead {
  std::uint32_t n_subtrees = 0;
};

struct SumsHead {
  std::uint32_t list = 0, n_left = 0;
  std::uint64_t n_messages = 0;  // of sums, by the rank; its first has what is left
};

struct RunHead {
  std::uint64_t first = 0, n = 0;  // places
};

// The next run of places at or behind `from` that have sums; at most so many.
RunHead next_run(std::span<const layout::i64> sums, std::uint64_t from, std::uint64_t most) {
  const std::uint64_t n_places = sums.size() / 3;
  const auto has_some = [&](std::uint64_t p) {
    return (sums[3 * p] | sums[3 * p + 1] | sums[3 * p + 2]) != 0;
  };
  while (from < n_places && !has_some(from)) ++from;
  RunHead run{from, 0};
  while (run.n < most && run.first + run.n < n_places && has_some(run.first + run.n)) ++run.n;
  return run;
}

// All runs, as the bytes of several messages, without heads.
std::vector<transport::Bytes> pack_sums(std::span<const layout::i64> sums) {
  std::vector<transport::Bytes> packed(1);
  const std::uint64_t most = kMostSumBytes / (3 * sizeof(layout::i64));
  for (RunHead run = next_run(sums, 0, most); run.n > 0; run = next_run(sums, run.first + run.n, most)) {
    if (packed.back().size() >= kMostSumBytes) packed.emplace_back();
    packed.back().append(reinterpret_cast<const char*>(&run), sizeof run);
    packed.back().append(reinterpret_cast<const char*>(&sums[3 * run.first]),
                         3 * run.n * sizeof(layout::i64));
  }
  return packed;
}

void add_runs(transport::Reader& reader, const transport::Message& message, std::span<layout::i64> sums) {
  while (!reader.is_at_end()) {
    const auto run = reader.get<RunHead>();
    if (run.first > sums.size() / 3 || run.n > sums.size() / 3 - run.first) refuse(message);
    for (layout::i64& sum : sums.subspan(3 * run.first, 3 * run.n))  // wraps around, as in kernels
      sum = static_cast<layout::i64>(static_cast<std::uint64_t>(sum) + reader.get<std::uint64_t>());
  }
}

}  // namespace

std::vector<std::uint32_t> share_division(transport::Ranks& ranks, std::vector<std::uint32_t> part_of) {
  const DivisionHead head{static_cast<std::uint32_t>(part_of.size())};
  if (ranks.leads()) {
    ranks.send_to_others(transport::kTagsOfDivisions.first, to_bytes(head, part_of));
    return part_of;
  }
  const transport::Message message = ranks.wait(transport::kTagsOfDivisions);
  std::vector<std::uint32_t> told = transport::words_behind<DivisionHead>(message);
  if (message.from != 0 || told.size() != head_of<DivisionHead>(message).n_subtrees) refuse(message);
  return told;
}

std::uint32_t begin_list(transport::Ranks& ranks, ListHead head, std::span<const layout::u32> entries,
                         std::span<const layout::u32> samples) {
  head.list = ranks.next_number();
  head.n_entries = entries.size();
  transport::Bytes bytes = to_bytes(head, entries);
  bytes.append(reinterpret_cast<const char*>(samples.data()), samples.size_bytes());
  ranks.send_to_others(kList, bytes);
  return head.list;
}

std::optional<List> next_list(transport::Ranks& ranks) {
  const transport::Message message = ranks.wait(transport::kTagsOfLists);
  if (message.from != 0 || (message.tag != kList && message.tag != kFinish)) refuse(message);
  if (message.tag == kFinish) return std::nullopt;
  List list{head_of<ListHead>(message), {}, transport::words_behind<ListHead>(message)};
  if (list.head.n_entries > list.samples.size()) refuse(message);
  const auto end = list.samples.begin() + static_cast<std::ptrdiff_t>(list.head.n_entries);
  list.entries.assign(list.samples.begin(), end);
  list.samples.erase(list.samples.begin(), end);
  ranks.reach(list.head.list);
  return list;
}

void send_sums(transport::Ranks& ranks, std::uint32_t list, std::span<const layout::i64> sums,
               std::span<const layout::u32> left) {
  const std::vector<transport::Bytes> packed = pack_sums(sums);
  for (const transport::Bytes& runs : packed) {
    const SumsHead head{list, static_cast<std::uint32_t>(left.size()), packed.size()};
    ranks.send(0, kSums, to_bytes(head, std::exchange(left, {})) + runs);
  }
}

void gather_sums(transport::Ranks& ranks, std::uint32_t list, std::span<layout::i64> sums,
                 std::vector<layout::u32>& left) {
  const auto size = static_cast<std::size_t>(ranks.size());
  std::vector<std::uint64_t> n_expected(size, 1), n_come(size);
  n_expected[0] = 0;
  while (n_come != n_expected) {
    const transport::Message message = ranks.wait(transport::kTagsOfLists);
    const auto from = static_cast<std::size_t>(message.from);
    transport::Reader reader(message);
    const auto head = reader.get<SumsHead>();
    if (message.tag != kSums || head.list != list || from == 0) refuse(message);
    n_expected[from] = head.n_messages;
    if (++n_come[from] > head.n_messages) refuse(message);
    for (std::uint32_t i = 0; i < head.n_left; ++i) left.push_back(reader.get<layout::u32>());
    add_runs(reader, message, sums);
  }
}

void finish_lists(transport::Ranks& ranks,
                  const std::function<void(const transport::Message&)>& take_report) {
  ranks.send_to_others(kFinish, to_bytes(DivisionHead{}));
  std::vector<char> has_come(static_cast<std::size_t>(ranks.size()));
  for (int i = 1; i < ranks.size(); ++i) {
    const transport::Message message = ranks.wait(transport::kTagsOfLists);
    if (message.tag != kReport || std::exchange(has_come[static_cast<std::size_t>(message.from)], 1))
      refuse(message);
    take_report(message);
  }
}

}  // namespace kdray::odprt
