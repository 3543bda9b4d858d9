#include "apps/cli/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "base/text.h"
#include "cluster/transport/mpi.h"
#include "cluster/transport/simulated.h"

namespace kdray::cli {

namespace {

constexpr std::array<std::string_view, 3> kChoices = {"auto", "on", "off"},
                                          kHoldings = {"auto", "whole", "shares"};

std::shared_ptr<transport::Ranks>& this_run() {
  static std::shared_ptr<transport::Ranks> ranks;
  return ranks;
}

// Finds --mpi before the command line is parsed, which is done when the ranks are known, so that only one of
// them reports a mistake.
std::string choice_in(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--mpi" && i + 1 < arguments.size()) return arguments[i + 1];
    if (arguments[i].starts_with("--mpi=")) return arguments[i].substr(6);
  }
  return "auto";
}

bool wants_ranks(const std::vector<std::string>& arguments, const transport::Launched& launched) {
  if (arguments.size() < 2 || arguments[1] != "render") return false;
  const std::string choice = choice_in(arguments);
  return choice == "on" || (choice == "auto" && launched.ranks > 1);
}

std::optional<double> asked_in(const char* variable, double least, double most) {
  const char* const asked = std::getenv(variable);
  if (asked == nullptr || *asked == '\0') return std::nullopt;
  return parse_real(variable, asked, least, most);
}

// Makes the network slower, for measurements. KDRAY_MPI_DELAY: how many milliseconds longer every message
// takes; KDRAY_MPI_BANDWIDTH: how many gigabits a second a rank receives at most.
std::unique_ptr<transport::Transport> as_asked(std::unique_ptr<transport::Transport> mpi) {
  const auto delay = asked_in("KDRAY_MPI_DELAY", 0, 1000);
  const auto bandwidth = asked_in("KDRAY_MPI_BANDWIDTH", 1e-3, 1e6);
  if (!delay && !bandwidth) return mpi;
  transport::Link link{.latency = 1e-3 * delay.value_or(0)};
  if (bandwidth) link.bandwidth = 1e9 / 8 * *bandwidth;
  return transport::delayed(std::move(mpi), link);
}

// Ends a run that has failed of `error`. Returns the exit code.
int end_with(transport::Ranks& ranks, const Error& error) {
  if (!ranks.leads()) return ranks.wait_for_end(&error);
  const int code = error.code() == ErrorCode::internal ? 1 : static_cast<int>(error.code());
  say(error.what());
  ranks.end(code);
  return code;
}

int run_as_rank(transport::Ranks& ranks, const std::function<int()>& run) {
  try {
    transport::share_cores(ranks);
    const int code = run();
    if (!ranks.leads()) return ranks.wait_for_end(nullptr);
    ranks.end(code);
    return code;
  } catch (const transport::Ended& ended) {
    ranks.leave();
    return ended.exit_code;
  } catch (const Error& error) {
    return end_with(ranks, error);
  } catch (const std::bad_alloc&) {
    return end_with(ranks, Error(ErrorCode::out_of_memory, "out of memory; take fewer ranks to a machine"));
  } catch (const std::exception& error) {
    return end_with(ranks, Error(ErrorCode::internal, error.what()));
  }
}

constexpr std::uintmax_t kLargeFile = std::uintmax_t{64} << 20;

// A small scene is held whole by every rank: rays travel less where the costs of the whole are known, and
// where every rank holds what most rays come to. All ranks decide the same, even where they see different
// files.
bool wants_shares(const RenderArgs& o) {
  if (o.holding != Holding::automatic) return o.holding == Holding::shares;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(o.scene.file, error);
  return together_of_this_run()->any(!error && size >= kLargeFile);
}

void say_whole(const std::string& why, bool quiet) {
  if (!quiet) say("every rank holds the whole scene: " + why);
}

}  // namespace

int run_in_ranks(const std::vector<std::string>& arguments, const std::function<int()>& run) {
  const transport::Launched launched = transport::launched();
  if (!wants_ranks(arguments, launched)) return run();
  try {
    this_run() = std::make_shared<transport::Ranks>(as_asked(transport::open_mpi(launched.ranks)));
  } catch (const Error&) {
    // Processes that share a folder need no MPI, though srun may have started them.
    const bool shares =
        std::ranges::any_of(arguments, [](const std::string& a) { return a.starts_with("--share"); });
    if (shares && choice_in(arguments) == "auto") return run();
    if (launched.rank == 0) throw;
    return static_cast<int>(ErrorCode::usage);  // rank 0 finds the same, and says so
  }
  return run_as_rank(*this_run(), run);
}

const std::shared_ptr<transport::Ranks>& ranks_of_this_run() {
  return this_run();
}

// There is one for the whole run, since it numbers the steps.
std::shared_ptr<transport::Together> together_of_this_run() {
  static const auto together = std::make_shared<transport::Together>(*this_run());
  return together;
}

bool leads() {
  return !this_run() || this_run()->leads();
}

void add_ranks_options(CLI::App& app, Holding& holding) {
  add_text(
      app, "--mpi", shape_of(kChoices),
      "Render together with the other processes that mpirun or srun has started (default: auto, when it has)",
      [](const std::string& text) { parse_choice("--mpi", text, kChoices); })
      ->group("Division");
  add_choice(app, "--hold",
             "With ranks and odprt each holds the whole scene, or shares of it (default: auto, shares of a "
             "file of 64 MiB "
             "or more)",
             kHoldings, holding)
      ->group("Division");
}

void check_ranks(const RenderArgs& o) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::usage, what); };
  if (!ranks_of_this_run()) return;
  if (o.scene.is_stdin())
    refuse("every rank reads the scene, and standard input is rank 0's alone; name a file");
  if (o.checkpoint.restarts > 0)
    refuse("--restarts can't start the ranks of MPI again; run mpirun again with --resume (docs/cluster.md)");
  if (!o.checkpoint.share.empty() && o.checkpoint.frames)
    refuse(
        "ranks render the frames of a sequence one after the other; take --checkpoint for --share, or --mpi "
        "off");
  if (o.render.division != Division::bag)
    refuse("ranks take their tiles from a bag; leave --division out, or add --mpi off");
  if (!o.timeline.empty()) refuse("--trace tells of one process's queues; leave it out, or add --mpi off");
}

bool holds_shares(const RenderArgs& o) {
  if (!ranks_of_this_run() || o.render.mode != Mode::odprt) return false;
  if (!wants_shares(o)) return false;
  if (!o.render.channels.empty()) say_whole("--aov needs it", o.quiet);
  if (o.view.transparent) say_whole("--background transparent needs it", o.quiet);
  if (o.view.look == Look::studio) say_whole("--look studio needs it", o.quiet);
  const bool needs_whole = !o.render.channels.empty() || o.view.transparent || o.view.look == Look::studio;
  return !needs_whole && !o.tree.binary_form.value_or(true);  // what needs that, ODPRT refuses
}

std::string faults_of_rank(const std::string& faults, int rank) {
  std::string own;
  for (std::string fault : split_list(faults)) {
    if (const std::size_t slash = fault.find('/'); slash != std::string::npos) {
      if (fault.substr(0, slash) != std::to_string(rank)) continue;
      fault = fault.substr(slash + 1);
    }
    own += (own.empty() ? "" : ",") + fault;
  }
  return own;
}

}  // namespace kdray::cli
