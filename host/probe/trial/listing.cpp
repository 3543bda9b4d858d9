#include "probe/trial/listing.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "base/error.h"
#include "base/temporary_folder.h"
#include "device/opencl/platform.h"
#include "device/opencl/pocl_cache.h"
#include "probe/trial/trial.h"

namespace kdray::trial {

namespace fs = std::filesystem;

namespace {

constexpr const char* kVendors = "OCL_ICD_VENDORS";
constexpr const char* kTemporary = "kdray-vendors-";

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// Whether one of the names that the user gave is part of the driver's. Numbers and kinds are no names of
// drivers; nor are names of devices, but what is part of both is wanted all the same.
bool is_insisted(const Driver& driver, const std::string& specs) {
  const std::string name = lower(driver.name());
  std::string rest = lower(specs);
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string spec = rest.substr(0, comma);
    rest.erase(0, comma + 1);
    const bool names_it = spec.size() > 2 && !device::is_auto(spec) && !device::is_kind(spec);
    if (names_it && name.find(spec) != std::string::npos) return true;
  }
  return false;
}

// A folder with these drivers alone. It says the same as they do, whatever becomes of them.
void show(const fs::path& folder, const std::vector<const Driver*>& drivers) {
  fs::create_directory(folder);
  for (const Driver* d : drivers)
    if (!d->library.empty()) std::ofstream(folder / d->file.filename()) << d->library << '\n';
}

// Where trials find their drivers.
class Vendors {
 public:
  // Environment for a child that is to see this driver alone; nothing where it can't be made.
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

// A driver and what is to be found out about it.
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

// The loader must not see the others, neither in this process nor in its children. The folder stays as long
// as the process.
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

// Asks the only driver in this process, which remembers the answer.
void ask_here(Case& only, const ListingOptions& options) {
  const device::Mark mark(options.verdicts, only.key);
  device::find_devices();
  options.verdicts.note(only.key, {true, ""});
}

std::vector<DriverVerdict> decide(const ListingOptions& options) {
  std::vector<Case> cases;
  for (const Driver& driver : registered_drivers()) {
    Case& c = cases.emplace_back(driver, key_of(driver));
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
