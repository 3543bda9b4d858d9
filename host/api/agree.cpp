#include "api/agree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "api/checkpoint.h"
#include "api/film_memory.h"

namespace kdray::api {

namespace {

constexpr transport::Tag kFrame = transport::kTagsOfFrames.first;

checkpoint::Cut cut_of_schedule(State& state, const Job& job) {
  const wavefront::Schedule schedule = state.scheduler.schedule_for(state.devices.first(), job);
  return {job.frame.width, job.frame.height, schedule.tile_width, schedule.tile_height};
}

// What follows the header.
struct Rest {
  std::uint64_t film_bytes = 0;  // of PDPRT
  std::uint32_t mode = 0, unused = 0;
};

Mode lead(State& state, Job& job, Mode mode) {
  const checkpoint::Header header{.identity = identity_of(state, job),
                                  .cut = job.checkpoint ? job.checkpoint->cut() : cut_of_schedule(state, job),
                                  .maker = "rank 0"};
  if (mode == Mode::pdprt) job.film_of_ranks = film_bytes(state, job);
  job.shared_frame = header.frame();
  job.options.tile_width = static_cast<int>(header.cut.tile_width);
  job.options.tile_height = static_cast<int>(header.cut.tile_height);
  transport::Bytes bytes = checkpoint::to_bytes(header);
  const Rest rest{job.film_of_ranks, static_cast<std::uint32_t>(mode)};
  bytes.append(reinterpret_cast<const char*>(&rest), sizeof rest);
  state.ranks->send_to_others(kFrame, bytes);
  return mode;
}

void check_same(const checkpoint::Identity& own, const checkpoint::Identity& first) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::input,
                fmt::format("this rank has {} than rank 0; all of them need the same", what));
  };
  if (own.build != first.build)
    refuse(fmt::format("another kdray or driver ({}; there: {})", own.build_text, first.build_text));
  if (own.scene != first.scene) refuse("another scene");
  if (own.settings != first.settings) refuse(fmt::format("other settings ({})", own.settings_text));
}

Mode follow(State& state, Job& job) {
  const transport::Message message = state.ranks->wait(transport::kTagsOfFrames);
  const auto header = checkpoint::header_of(message.bytes);
  Rest rest;
  if (message.from == 0 && header && message.bytes.size() == checkpoint::kHeaderBytes + sizeof rest)
    std::memcpy(&rest, message.bytes.data() + checkpoint::kHeaderBytes, sizeof rest);
  const auto mode = static_cast<Mode>(rest.mode);
  if (!header || (mode != Mode::pdprt && mode != Mode::odprt))
    throw Error(ErrorCode::input, "rank 0 is of another version of kdray than this rank");
  check_same(identity_of(state, job), header->identity);
  job.options.tile_width = static_cast<int>(header->cut.tile_width);
  job.options.tile_height = static_cast<int>(header->cut.tile_height);
  job.shared_frame = header->frame();
  if (mode == Mode::odprt) return mode;
  const std::uint64_t film = rest.film_bytes;
  if (const std::size_t own = film_bytes(state, job); own < film)
    throw Error(ErrorCode::out_of_memory,
                fmt::format("this rank's devices have room for {} MiB of a film, rank 0's for {}", own >> 20,
                            film >> 20));
  job.film_of_ranks = film;
  return mode;
}

}  // namespace

Mode agree(State& state, Job& job, Mode mode) {
  return state.ranks->leads() ? lead(state, job, mode) : follow(state, job);
}

}  // namespace kdray::api
