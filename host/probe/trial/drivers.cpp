#include "probe/trial/drivers.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>

namespace kdray::trial {

namespace fs = std::filesystem;

namespace {

// An .icd file: its first line names the library.
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

// What variables begin with that switch drivers on, or others in their place, and those that say which
// libraries are loaded. Variables that choose among a driver's devices are not of them: batch systems set
// them anew for each job.
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

// A file's size and the moment of its last change: another one has others.
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

}  // namespace kdray::trial
