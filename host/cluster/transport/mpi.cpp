#include "cluster/transport/mpi.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "base/error.h"
#include "base/timer.h"
#include "cluster/transport/mpi_plugin/mpi_plugin.h"

namespace kdray::transport {

namespace {

// The variables in which launchers tell a process the number of ranks, and its own. Slurm's are of a step: a
// batch script has others, though it is no rank.
struct Variables {
  const char *ranks, *rank, *by;
};
constexpr Variables kLaunchers[] = {{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK", "mpirun"},
                                    {"PMI_SIZE", "PMI_RANK", "mpirun"},
                                    {"SLURM_STEP_NUM_TASKS", "SLURM_PROCID", "srun"}};

int number(const char* variable) {
  const char* const value = std::getenv(variable);
  if (value == nullptr) return -1;
  const std::string_view text = value;
  int n = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  return error == std::errc() && end == text.data() + text.size() ? n : -1;
}

constexpr Tag kPlace = kTagsOfCores.first, kShare = kPlace + 1;

struct Share {
  std::uint32_t index = 0, n = 1;
};

std::vector<int> allowed_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (::sched_getaffinity(0, sizeof set, &set) != 0) return cores;  // over 1024 cores
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

// Returns the machine and its cores as text, which is the same for ranks that share them.
Bytes place_of(const std::vector<int>& cores) {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) name[0] = '?';
  Bytes place = name.data();
  for (const int core : cores) place += "," + std::to_string(core);
  return place;
}

Share deal_out(Ranks& ranks, const Bytes& own) {
  std::map<Bytes, std::vector<int>> sharing;
  sharing[own].push_back(0);
  for (int n = 1; n < ranks.size(); ++n) {
    const Message message = ranks.wait(kTagsOfCores);
    sharing[message.bytes].push_back(message.from);
  }
  const auto n_of = [](const std::vector<int>& list) { return static_cast<std::uint32_t>(list.size()); };
  for (const auto& [place, list] : sharing)
    for (std::uint32_t i = 0; i < n_of(list); ++i) {
      if (list[i] == 0) continue;
      const Share share{i, n_of(list)};
      ranks.send(list[i], kShare, Bytes(reinterpret_cast<const char*>(&share), sizeof share));
    }
  return {0, n_of(sharing[own])};
}

Share ask_for_share(Ranks& ranks, const Bytes& own) {
  ranks.send(0, kPlace, own);
  const Message message = ranks.wait(kTagsOfCores);
  Share share;
  if (message.bytes.size() == sizeof share) std::memcpy(&share, message.bytes.data(), sizeof share);
  if (share.n == 0 || share.index >= share.n)
    throw Error(ErrorCode::internal, "rank 0 has dealt out no cores");
  return share;
}

}  // namespace

Launched launched() {
  for (const Variables& v : kLaunchers) {
    const int ranks = number(v.ranks), rank = number(v.rank);
    if (ranks > 0 && rank >= 0 && rank < ranks) return {ranks, rank, v.by};
  }
  return {};
}

std::vector<int> cores_of(const std::vector<int>& cores, std::size_t index, std::size_t n) {
  if (cores.size() < n) return cores;
  const auto at = [&](std::size_t i) {
    return cores.begin() + static_cast<std::ptrdiff_t>(i * cores.size() / n);
  };
  return {at(index), at(index + 1)};
}

void share_cores(Ranks& ranks) {
  const std::vector<int> all = allowed_cores();
  const Bytes place = place_of(all);
  const Share share = ranks.leads() ? deal_out(ranks, place) : ask_for_share(ranks, place);
  if (all.empty()) return;
  const std::vector<int> own = cores_of(all, share.index, share.n);
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : own) CPU_SET(static_cast<unsigned>(core), &set);
  if (own != all)
    ::sched_setaffinity(0, sizeof set, &set);  // where that is forbidden, threads are only fewer
  const std::size_t n_threads = all.size() < share.n ? 1 : own.size();
  ::setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(n_threads).c_str(), 0);
}

namespace {

namespace fs = std::filesystem;
using Functions = kdray_mpi_functions;

constexpr const char* kName = "libkdray-mpi.so";

Error no_mpi(const std::string& why) {
  return Error(ErrorCode::usage, fmt::format("no MPI: {}; --mpi off makes each process work by itself", why));
}

std::vector<fs::path> places() {
  if (const char* const asked = std::getenv("KDRAY_MPI_PLUGIN"); asked != nullptr && *asked != '\0')
    return {asked};
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path installed = here / ".." / KDRAY_INSTALLED_LIBRARIES;
  return {here / ".." / "lib" / kName, installed / "kdray" / kName, here / kName, kName};
}

// It stays until the process ends: an MPI can't be opened twice.
void* open_plugin() {
  std::string why;
  for (const fs::path& place : places()) {
    std::error_code error;
    if (place.has_parent_path() && !fs::exists(place, error)) continue;
    // An MPI's own plugins look for its symbols among all.
    if (void* const plugin = ::dlopen(place.c_str(), RTLD_NOW | RTLD_GLOBAL)) return plugin;
    why = ::dlerror();
  }
  throw no_mpi(why.empty() ? fmt::format("{} is not there", places().front().string()) : why);
}

const Functions& functions_of(void* plugin) {
  const auto entry = reinterpret_cast<kdray_mpi_entry>(::dlsym(plugin, KDRAY_MPI_ENTRY));
  const Functions* const functions = entry != nullptr ? entry(KDRAY_MPI_VERSION) : nullptr;
  if (functions == nullptr || functions->version != KDRAY_MPI_VERSION ||
      functions->bytes != sizeof(Functions))
    throw no_mpi(fmt::format("{} is of another version of kdray", kName));
  return *functions;
}

class Mpi final : public Transport {
 public:
  Mpi(const Functions& mpi, int rank, int ranks) : Transport(rank, ranks), mpi_(mpi) {}

  std::size_t bytes_waiting() const override { return bytes_waiting_; }
  double now() const override { return clock_.seconds(); }

  void close() override {
    check(mpi_.close(), "closing");
    sending_.clear();
  }

  [[noreturn]] void abort(int exit_code) override {
    mpi_.abort(exit_code);
    std::_Exit(exit_code);
  }

 private:
  int check(int result, const char* what) const {
    if (result < 0) throw Error(ErrorCode::internal, fmt::format("MPI failed at {}: {}", what, mpi_.error()));
    return result;
  }

  void post(int to, Tag tag, Bytes bytes) override {
    const std::uint64_t ticket = next_ticket_++;
    bytes_waiting_ += bytes.size();
    const Bytes& kept = sending_.emplace(ticket, std::move(bytes)).first->second;
    check(mpi_.send(to, tag, kept.data(), kept.size(), ticket), "sending");
  }

  void forget_sent() {
    for (std::uint64_t ticket = 0; !sending_.empty() && check(mpi_.sent(&ticket), "sending") == 1;) {
      const auto found = sending_.find(ticket);
      if (found == sending_.end()) throw Error(ErrorCode::internal, "MPI has sent what kdray hasn't");
      bytes_waiting_ -= found->second.size();
      sending_.erase(found);
    }
  }

  void begin_to_receive() {
    int from = 0, tag = 0;
    std::size_t n = 0;
    while (check(mpi_.probe(&from, &tag, &n), "looking for messages") == 1) {
      if (tag < 0 || tag > kMostTag || n > kMostBytes)
        throw Error(ErrorCode::internal,
                    fmt::format("rank {} got {} bytes with tag {} from rank {}", rank(), n, tag, from));
      const std::uint64_t ticket = next_ticket_++;
      Message& message =
          coming_.emplace(ticket, Message{from, static_cast<Tag>(tag), Bytes(n, '\0')}).first->second;
      check(mpi_.receive(message.bytes.data(), ticket), "receiving");
    }
  }

  std::optional<Message> take() override {
    forget_sent();
    begin_to_receive();
    std::uint64_t ticket = 0;
    if (coming_.empty() || check(mpi_.received(&ticket), "receiving") == 0) return std::nullopt;
    const auto found = coming_.find(ticket);
    if (found == coming_.end())
      throw Error(ErrorCode::internal, "MPI has received what kdray hasn't asked for");
    Message message = std::move(found->second);
    coming_.erase(found);
    return message;
  }

  const Functions& mpi_;
  Timer clock_;
  std::uint64_t next_ticket_ = 0;
  std::unordered_map<std::uint64_t, Bytes> sending_;  // elements don't move, in both
  std::unordered_map<std::uint64_t, Message> coming_;
  std::size_t bytes_waiting_ = 0;
};

}  // namespace

std::unique_ptr<Transport> open_mpi(int expected) {
  const Functions& mpi = functions_of(open_plugin());
  if (mpi.open() < 0) throw no_mpi(mpi.error());
  const int rank = mpi.rank(), ranks = mpi.ranks();
  if (rank < 0 || ranks < 1 || rank >= ranks) throw no_mpi(fmt::format("it has rank {} of {}", rank, ranks));
  if (expected > 0 && ranks != expected)
    throw no_mpi(
        fmt::format("the launcher has started {} ranks, and {} ({}) sees {}; build the plugin against the "
                    "launcher's MPI (docs/cluster.md)",
                    expected, kName, mpi.library(), ranks));
  return std::make_unique<Mpi>(mpi, rank, ranks);
}

}  // namespace kdray::transport
