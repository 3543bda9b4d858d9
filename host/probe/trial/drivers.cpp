#include "probe/trial/drivers.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>

#include "base/error.h"
#include "base/temporary.h"
#include "base/text.h"
#include "device/opencl/platform.h"
#include "device/opencl/pocl_cache.h"
#include "probe/trial/trial.h"

namespace kdray::trial {

namespace fs = std::filesystem;

namespace {

// Reads an .icd file, whose first line names the library.
Driver read(const fs::path& file) {
  Driver driver{.file = file, .library = {}, .unreadable = {}};
  std::ifstream in(file);
  std::getline(in, driver.library);
  const bool is_text = std::none_of(driver.library.begin(), driver.library.end(),
                                    [](unsigned char c) { return std::iscntrl(c) && !std::isspace(c); });
  if (!is_text) driver.library.clear();
  if (driver.library.empty())
    driver.unreadable =
        is_text ? "the file can't be read or is empty" : "the file is no text with a library's name";
  return driver;
}

// How the variables begin that switch drivers on, or others in their place, and that say which libraries are
// loaded. Variables that choose among a driver's devices don't count: batch systems set them anew for each
// job.
constexpr std::string_view kSwitches[] = {
    "POCL_", "RUSTICL_", "CLOVER_",    "MESA_",     "GALLIUM_",         "LP_",        "LIBGL_",
    "NEO",   "IGC_",     "CL_CONFIG_", "OCLGRIND_", "LD_LIBRARY_PATH=", "LD_PRELOAD="};

bool is_switch(std::string_view variable) {
  return !variable.starts_with("POCL_CACHE_DIR=") && !variable.starts_with("POCL_MAX_PTHREAD_COUNT=") &&
         std::ranges::any_of(kSwitches, [&](std::string_view s) { return variable.starts_with(s); });
}

std::string switches() {
  std::vector<std::string> set;
  for (char** variable = environ; variable && *variable; ++variable)
    if (is_switch(*variable)) set.emplace_back(*variable);
  std::sort(set.begin(), set.end());
  return fmt::format("{}", fmt::join(set, "\n"));
}

// Returns a file's size and the moment of its last change, by which another file is told apart.
std::string state_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "none";
  return fmt::format("{} {}.{}", status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

}  // namespace

std::string Driver::name() const {
  return is_library ? library : fmt::format("{} ({})", library, file.filename().string());
}

std::string Driver::where() const {
  return is_library ? "OCL_ICD_VENDORS" : file.string();
}

fs::path vendors_folder() {
  const char* const set = std::getenv("OCL_ICD_VENDORS");
  return set && *set ? set : "/etc/OpenCL/vendors";
}

std::vector<Driver> registered_drivers() {
  std::vector<Driver> drivers;
  const fs::path place = vendors_folder();
  std::error_code error;
  if (place.extension() == ".icd") return {read(place)};
  if (place.filename().string().find(".so") != std::string::npos && !fs::is_directory(place, error))
    return {{.file = place, .library = place.string(), .unreadable = {}, .is_library = true}};
  for (fs::directory_iterator i(place, error), end; !error && i != end; i.increment(error))
    if (i->path().extension() == ".icd") drivers.push_back(read(i->path()));
  std::sort(drivers.begin(), drivers.end(), [](const Driver& a, const Driver& b) { return a.file < b.file; });
  return drivers;
}

// A library without a folder is wherever the dynamic linker finds it; its cache is made anew whenever a
// package brings another one.
Hash key_of(const Driver& driver) {
  const bool has_folder = driver.library.find('/') != std::string::npos;
  return hash_of(fmt::format("kdray driver 1\n{}\n{}\n{}\n{}\n{}", driver.file.string(),
                             state_of(driver.file), driver.library,
                             state_of(has_folder ? driver.library : "/etc/ld.so.cache"), switches()));
}

namespace {

constexpr const char* kVendors = "OCL_ICD_VENDORS";
constexpr const char* kTemporary = "kdray-vendors-";

// Returns whether one of the names that the user gave is part of the driver's. Numbers and kinds of devices
// don't count. Names of devices are not meant for drivers either, but one that is part of both counts.
bool is_insisted(const Driver& driver, const std::string& specs) {
  const std::string name = lower(driver.name());
  for (const std::string& spec : split_list(lower(specs))) {
    const bool names_it = spec.size() > 2 && !device::is_auto(spec) && !device::is_kind(spec);
    if (names_it && name.find(spec) != std::string::npos) return true;
  }
  return false;
}

// Makes a folder that registers these drivers alone. It has copies of what their files say, whatever becomes
// of these.
void show(const fs::path& folder, const std::vector<const Driver*>& drivers) {
  fs::create_directory(folder);
  for (const Driver* d : drivers)
    if (!d->library.empty()) std::ofstream(folder / d->file.filename()) << d->library << '\n';
}

// The folders in which trials find their drivers.
class Vendors {
 public:
  // Returns the environment for a child that sees this driver alone; nothing where it can't be made.
  std::optional<std::map<std::string, std::string>> of(const Driver& driver) {
    if (driver.is_library || vendors_folder().extension() == ".icd")
      return std::map<std::string, std::string>{};  // it is the only one
    if (!folder_) folder_ = make_temporary_folder(kTemporary);
    if (!folder_) return std::nullopt;
    const fs::path own = folder_->path() / driver.file.stem();
    show(own, {&driver});
    return std::map<std::string, std::string>{{kVendors, own.string()}};
  }

 private:
  std::unique_ptr<Temporary> folder_;
};

// A driver, and what is found out about it.
struct Case {
  Driver driver;
  Hash key;
  std::optional<device::Verdict> verdict = {};
  std::unique_ptr<Trial> trial = {};
};

void try_in_children(std::vector<Case>& cases, const ListingOptions& options) {
  Vendors vendors;
  if (options.watch) options.watch(true);
  for (Case& c : cases)
    if (!c.verdict)
      if (const auto environment = vendors.of(c.driver))
        c.trial = std::make_unique<Trial>(Subject::driver, c.key, *environment);
  for (Case& c : cases) {
    if (!c.trial) continue;
    const Outcome& outcome = c.trial->outcome();
    c.verdict = outcome.verdict;
    if (c.verdict && outcome.lasting) options.verdicts.note(c.key, *c.verdict);
    if (c.verdict) device::Mark::forget(options.verdicts, c.key);
  }
  if (options.watch) options.watch(false);
}

// Makes the loader see these drivers alone, in this process and in its children. The folder stays as long as
// the process.
void show_only(const std::vector<const Driver*>& drivers) {
  static std::unique_ptr<Temporary> folder;
  folder = make_temporary_folder(kTemporary);
  if (!folder)
    throw Error(
        ErrorCode::no_device,
        fmt::format("a driver of {} has to be left out, which takes a folder for temporary files: set "
                    "TMPDIR to one of yours",
                    vendors_folder().string()));
  show(folder->path() / "left", drivers);
  ::setenv(kVendors, (folder->path() / "left").c_str(), 1);
}

std::vector<DriverVerdict> leave_out(std::vector<Case>& cases, const std::string& insisted) {
  std::vector<DriverVerdict> verdicts;
  std::vector<const Driver*> left;
  for (Case& c : cases) {
    const bool failed = c.verdict && !c.verdict->passed;
    const bool out = failed && !is_insisted(c.driver, insisted);
    if (!out) left.push_back(&c.driver);
    verdicts.push_back({c.driver, c.verdict.value_or(device::Verdict{true, ""}), out});
  }
  if (left.size() < cases.size()) show_only(left);
  return verdicts;
}

// Asks the only driver for its devices in this process.
void ask_here(Case& only, const ListingOptions& options) {
  const device::Mark mark(options.verdicts, only.key);
  device::find_devices();
  options.verdicts.note(only.key, {true, ""});
}

std::vector<DriverVerdict> decide(const ListingOptions& options) {
  std::vector<Case> cases;
  for (const Driver& driver : registered_drivers()) {
    Case& c = cases.emplace_back(Case{driver, key_of(driver)});
    if (!driver.unreadable.empty())
      c.verdict = device::Verdict{true, ""};  // the loader passes over it
    else if (!options.anew)
      c.verdict = options.verdicts.find(c.key);
  }
  const bool all_known = std::ranges::all_of(cases, [](const Case& c) { return c.verdict.has_value(); });
  const bool only = cases.size() == 1 && !options.anew;
  if (!all_known && (!only || device::Mark::is_left(options.verdicts, cases.front().key)))
    try_in_children(cases, options);
  std::vector<DriverVerdict> verdicts = leave_out(cases, options.insisted);
  if (only && !cases.front().verdict) ask_here(cases.front(), options);
  return verdicts;
}

}  // namespace

std::string DriverVerdict::in_words() const {
  return fmt::format(
      "the driver {} {}; {}`kdray doctor` tries it again", driver.name(), verdict.text,
      left_out ? fmt::format("it is left out, `--device {}` insists on it, ", driver.file.filename().string())
               : "");
}

const std::vector<DriverVerdict>& mind_drivers(const ListingOptions& options) {
  static std::mutex mutex;
  static std::optional<std::vector<DriverVerdict>> decided;
  const std::lock_guard lock(mutex);
  if (!decided) {
    device::pocl_cache();  // the children's too
    decided = decide(options);
  }
  return *decided;
}

}  // namespace kdray::trial
