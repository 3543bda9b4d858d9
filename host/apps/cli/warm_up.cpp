// What    kdray warm-up: compiles beforehand what any scene's first picture would wait for.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/options.h"
#include "apps/cli/output.h"
#include "base/error.h"
#include "base/timer.h"
#include "device/tuning/database.h"
#include "kdray/kdray.h"

namespace kdray::cli {

namespace {

struct WarmUpArgs {
  DeviceOptions device;
  std::string folder;  // --cache
  std::uint64_t largest = std::numeric_limits<std::uint64_t>::max();
  bool quiet = false;
};

std::string line_of(const WarmProgram& p) {
  return fmt::format("{}: {}", p.what,
                     p.compiled ? "compiled in " + seconds_in_words(p.seconds) : std::string("is there"));
}

std::string summary_of(const std::vector<WarmProgram>& all, const std::string& folder, double seconds) {
  const auto compiled = std::ranges::count_if(all, &WarmProgram::compiled);
  return fmt::format("{} of {} compiled in {}, kept in {}: scenes find them there from now on", compiled,
                     all.size(), seconds_in_words(seconds), folder);
}

int run(WarmUpArgs& o) {
  const Timer timer;
  o.device.programs =
      o.folder.empty() ? default_program_folder() : std::filesystem::path(o.folder) / "programs";
  std::string device;
  const auto tell = [&](const WarmProgram& p) {
    if (o.quiet) return;
    if (device != p.device) say(device = p.device);
    say(line_of(p));
  };
  const std::vector<WarmProgram> all = warm_up(o.device, tell, o.largest);
  if (!o.quiet) say(summary_of(all, o.device.programs.string(), timer.seconds()));
  return 0;
}

}  // namespace

Command add_warm_up(CLI::App& kdray) {
  CLI::App* const app =
      kdray.add_subcommand("warm-up", "Compile beforehand what any scene's first picture would wait for");
  const auto o = std::make_shared<WarmUpArgs>();
  o->device.tunings = tuning::default_file();
  add_device_option(*app, "The device, as for render; several with commas", o->device.device);
  add_schedule_option(*app, "Launches, as for render: auto (default), slices, global", o->device);
  add_text(*app, "--cache", "DIR",
           "Keep the programs there, as for render (default: the user's cache directory)",
           [o](const std::string& text) {
             if (text.empty()) throw usage_error("--cache", text, "a folder");
             o->folder = text;
           });
  add_text(*app, "--largest", "BYTES",
           "Only what scenes need whose tree takes no more, as in 4M (default: all scenes)",
           [o](const std::string& text) { o->largest = parse_bytes("--largest", text); });
  app->add_flag("-q,--quiet", o->quiet, "Say nothing unless something is wrong");
  return {app, [o] { return run(*o); }};
}

}  // namespace kdray::cli
