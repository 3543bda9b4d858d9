#include "cluster/transport/mpi.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <unordered_map>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/timer.h"
#include "cluster/transport/mpi_plugin/mpi_plugin.h"

namespace kdray::transport {

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
