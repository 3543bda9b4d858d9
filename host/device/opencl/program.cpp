#include "device/opencl/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include "device/opencl/opencl_error.h"
#include "device/opencl/pocl_cache.h"
#include "device/opencl/program_cache.h"
#include "kernels.h"

namespace kdray::device {

namespace {

std::string text_of(const std::string& name) {
  if (const char* folder = std::getenv("KDRAY_KERNEL_DIR")) {
    std::ifstream in(std::filesystem::path(folder) / name, std::ios::binary);
    if (!in)
      throw input_error((std::filesystem::path(folder) / name).string(), 0, "cannot be read",
                        "unset KDRAY_KERNEL_DIR to use the built-in kernels");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
  }
  for (const kernels::Source& source : kernels::sources())
    if (source.name == name) return std::string(source.text);
  throw Error(ErrorCode::internal, fmt::format("kernel source '{}' is not embedded", name));
}

constexpr std::string_view kInclude = "#include \"";  // of ours; <system> includes are left alone

// Returns where the next line begins that includes one of kdray's files, from `first` on, which begins a
// line.
std::size_t next_include(std::string_view source, std::size_t first) {
  std::size_t at = source.find(kInclude, first);
  while (at != std::string_view::npos && at > 0 && source[at - 1] != '\n') at = source.find(kInclude, at + 1);
  return std::min(at, source.size());
}

// Copies whole pieces between includes, not lines: every start of kdray computes the keys of some sources.
void expand(const std::string& name, std::string_view source, std::set<std::string>& seen, std::string& out) {
  seen.insert(name);
  out += fmt::format("#line 1 \"{}\"\n", name);
  std::ptrdiff_t number = 1;
  for (std::size_t at = 0; at < source.size();) {
    const std::size_t include = next_include(source, at);
    const std::string_view piece = source.substr(at, include - at);
    out += piece;
    number += std::ranges::count(piece, '\n');
    if (include == source.size()) break;
    const std::size_t end = std::min(source.find('\n', include), source.size());
    const std::size_t begin = include + kInclude.size();
    const std::string_view line = source.substr(begin, end - begin);
    const std::string included(line.substr(0, line.find('"')));
    if (seen.contains(included)) {
      out += '\n';
    } else {
      expand(included, text_of(included), seen, out);
      out += fmt::format("#line {} \"{}\"\n", number + 1, name);
    }
    ++number;
    at = end + 1;
  }
  if (!out.ends_with('\n')) out += '\n';
}

std::string first_error(const std::string& log) {
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (line.find("error") != std::string::npos) return line;
  return log.substr(0, log.find('\n'));
}

[[noreturn]] void report_failed_build(const std::string& platform, const std::string& file,
                                      const std::string& options, const std::string& source,
                                      const std::string& log) {
  const std::filesystem::path cache = pocl_cache().folder;
  if (const std::string why = why_no_cache(cache); is_pocl(platform) && !why.empty())
    throw input_error(cache.string(), 0, "PoCL can't compile there: " + why,
                      "free some space, or set POCL_CACHE_DIR to a folder of yours");
  std::string name = file;
  for (char& c : name)
    if (c == '/') c = '_';
  const std::filesystem::path dump = std::filesystem::temp_directory_path() / ("kdray_failed_" + name);
  std::ofstream out(dump);
  out << "// options: " << options << "\n" << source << "\n/* build log:\n" << log << "\n*/\n" << std::flush;
  throw Error(ErrorCode::no_device,
              fmt::format("the device's compiler refuses {}: {}{}", file, first_error(log),
                          out ? "; source and log are in " + dump.string() : std::string()));
}

}  // namespace

std::string expand_text(const std::string& name, const std::string& text) {
  std::set<std::string> seen;
  std::string out;
  expand(name, text, seen, out);
  return out;
}

std::string expand_source(const std::string& file) {
  return expand_text(file, text_of(file));
}

namespace {

// Compiles, and notes the program under the key where there is a cache. Returns an empty program where the
// compiler refuses.
cl::Program compile(const cl::Context& context, const std::vector<cl::Device>& devices,
                    const std::string& source, const std::string& options, const ProgramKey& key,
                    const Builds& builds, std::string& log) {
  const AtWork at_work(builds);
  cl::Program program(context, source);
  try {
    program.build(devices, (options + " -w").c_str());  // compilers print how many warnings there were
  } catch (const cl::Error& error) {
    if (error.err() != CL_BUILD_PROGRAM_FAILURE) throw;
    log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(devices.front());
    return {};
  }
  if (builds.cache) builds.cache->built(key, program);
  return program;
}

[[noreturn]] void report_failed_build(const std::vector<cl::Device>& devices, const std::string& file,
                                      const std::string& options, const std::string& source,
                                      const std::string& log) {
  const cl::Platform platform(devices.front().getInfo<CL_DEVICE_PLATFORM>());
  report_failed_build(platform.getInfo<CL_PLATFORM_NAME>(), file, options, source, log);
}

}  // namespace

cl::Program try_build(const cl::Context& context, const std::vector<cl::Device>& devices,
                      const std::string& source, const std::string& options, const Builds& builds,
                      std::string& log) {
  Hash key;
  if (builds.cache) {
    key = program_key(identity_of(devices.front()), source, options);
    if (const auto found = builds.cache->find(context, devices, key, options)) return *found;
  }
  return compile(context, devices, source, options, key, builds, log);
}

cl::Program compile_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& name, const std::string& source, const std::string& options,
                           const ProgramKey& key, const Builds& builds) {
  std::string log;
  const cl::Program program = compile(context, devices, source, options, key, builds, log);
  if (program() == nullptr) report_failed_build(devices, name, options, source, log);
  return program;
}

cl::Program build_source(const cl::Context& context, const std::vector<cl::Device>& devices,
                         const std::string& name, const std::string& source, const std::string& options,
                         const Builds& builds) {
  std::string log;
  cl::Program program =
      checked("building " + name, [&] { return try_build(context, devices, source, options, builds, log); });
  if (program() == nullptr) report_failed_build(devices, name, options, source, log);
  return program;
}

cl::Program build_program(const cl::Context& context, const std::vector<cl::Device>& devices,
                          const std::string& file, const std::string& options, const Builds& builds) {
  return build_source(context, devices, file, expand_source(file), options, builds);
}

}  // namespace kdray::device
