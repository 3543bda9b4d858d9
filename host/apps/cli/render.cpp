// What    kdray render: a scene to a picture, or to the pictures of a sequence.
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/command.h"
#include "apps/cli/help.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "apps/cli/ranks.h"
#include "apps/cli/render_frame.h"
#include "apps/cli/render_options.h"
#include "apps/cli/sequence.h"
#include "base/child.h"
#include "base/error.h"

namespace kdray::cli {

namespace {

void add_file_options(CLI::App& app, RenderArgs& o) {
  static constexpr std::array<std::string_view, 2> kBits = {"8", "16"};
  static constexpr std::array<std::string_view, 7> kChannels = {"depth", "normal", "primitive", "instance",
                                                                "cost",  "queue",  "samples"};
  add_path(app, "-o,--output",
           "The picture, .png or .exr; '-': standard output (default: the scene's name with .png, here)",
           o.output);
  add_picture_format(app, o.write.format);
  add_text(app, "--gamma", "srgb|G", "PNG's transfer curve: srgb (default) or v^(1/G)",
           [&o](const std::string& text) {
             o.write.transfer = parse_gamma("--gamma", text);
             o.gamma_given = true;
           });
  add_text(app, "--exposure", "EV", "A PNG shows colours times 2^EV (as in 1.5; default 0)",
           [&o](const std::string& text) {
             o.write.exposure = parse_real("--exposure", text, -100, 100);
             o.exposure_given = true;
           });
  add_text(app, "--bits", shape_of(kBits), "Bits per channel of a PNG (default 8)",
           [&o](const std::string& text) {
             o.write.png_bits = parse_choice("--bits", text, kBits) == 1 ? 16 : 8;
             o.bits_given = true;
           });
  add_list(app, "--aov", "More channels, in the EXR or as files beside the PNG", kChannels,
           o.render.channels);
  add_path(app, "--stats", "Write the run's figures as JSON ('-': to standard output)", o.stats);
  static constexpr std::array kOptions = {"--output", "--format", "--gamma", "--exposure",
                                          "--bits",   "--aov",    "--stats"};
  put_into_group(app, "Output", kOptions);
  add_loudness(app, o.quiet, o.verbose);
}

void add_trace_options(CLI::App& app, RenderArgs& o) {
  const std::string group = "Division";
  add_path(app, "--trace", "Write what each queue did when, for Perfetto (Chrome trace format)", o.timeline)
      ->group(group);
  add_text(app, "--inject-fault", "Q@N", "For tests: the Nth launch on queue Q fails (Q@N,Q@N,...)",
           [&o](const std::string& text) { o.hooks.faults = text; })
      ->group(group);
}

// --restarts starts this very command again, without that option, in a process of its own, and once more from
// its checkpoint whenever a signal has ended it. A run that ends by itself, well or not, is the end. So is
// one that somebody ended on purpose (SIGINT, SIGTERM, SIGHUP, SIGQUIT). The run ends when this process ends,
// whatever ended it.

// The arguments of this process without --restarts.
std::vector<std::string> own_arguments() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> arguments;
  for (std::size_t at = 0; at < all.size(); at = all.find('\0', at) + 1) {
    const std::string argument = all.c_str() + at;
    if (argument == "--restarts")
      at = all.find('\0', at) + 1;  // and its value
    else if (!argument.starts_with("--restarts="))
      arguments.push_back(argument);
  }
  return arguments;
}

// In the child: becomes the run. Only what is safe after a fork() of a process with threads is done here.
[[noreturn]] void become(char* const* arguments, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(1);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execv("/proc/self/exe", arguments);
  ::_exit(127);
}

int run_once(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(pointers.data(), parent);
  if (child < 0)
    throw Error(ErrorCode::internal, fmt::format("no process for the run ({})", std::strerror(errno)));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

bool is_on_purpose(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT;
}

// Returns the exit code of the last run.
int run_again(const CheckpointChoice& choice) {
  std::vector<std::string> arguments = own_arguments();
  for (int left = choice.restarts;; --left) {
    const int status = run_once(arguments);
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    const int signal = WTERMSIG(status);
    if (is_on_purpose(signal) || left == 0) {
      say(fmt::format("the run was ended by {}{}; what is finished is in {}", signal_name(signal),
                      is_on_purpose(signal) ? "" : ", and it was the last that --restarts allows",
                      choice.folder()));
      return 1;
    }
    say(fmt::format("the run was ended by {}; it goes on from {} ({} more {})", signal_name(signal),
                    choice.folder(), left - 1, left == 2 ? "restart" : "restarts"));
    if (choice.share.empty() && std::ranges::find(arguments, "--resume") == arguments.end())
      arguments.push_back("--resume");
  }
}

int run(RenderArgs& o) {
  if (const int n = o.checkpoint.turntable; n > 0 && !o.checkpoint.frames)
    o.checkpoint.frames = FrameRange{0, n - 1};
  check_checkpoint(o);
  check_ranks(o);
  if (ranks_of_this_run()) {
    o.hooks.ranks = ranks_of_this_run();
    o.hooks.faults = faults_of_rank(o.hooks.faults, o.hooks.ranks->rank());
    o.quiet = o.quiet || !leads();
  }
  if (o.checkpoint.restarts > 0) return run_again(o.checkpoint);
  if (o.checkpoint.frames) return render_sequence(o);
  o.render.ledger = o.checkpoint.options();
  FrameMaker(o).make(o);
  return 0;
}

}  // namespace

Command add_render(CLI::App& kdray) {
  CLI::App* const app = kdray.add_subcommand("render", "Render a scene to a picture");
  const auto o = std::make_shared<RenderArgs>();
  add_scene_input(
      *app, o->scene,
      "The scene: .nff .obj .ply .stl .gltf .glb .json, also .gz and .xz of them; '-': standard input");
  add_file_options(*app, *o);
  add_picture_options(*app, o->render);
  add_crop_option(*app, o->render);
  add_view_options(*app, o->view);
  add_division_options(*app, o->render);
  add_ranks_options(*app, o->holding);
  add_trace_options(*app, *o);
  add_checkpoint_options(*app, o->checkpoint);
  add_device_options(*app, o->device, o->render.traversal, o->render.precision);
  add_cache_options(*app, o->cache);
  add_tree_options(*app, o->tree);
  show_most_used_first(*app);
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
