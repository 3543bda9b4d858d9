#include "device/opencl/variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include "device/opencl/opencl_error.h"
#include "device/opencl/program.h"
#include "device/opencl/program_cache.h"

namespace kdray::device {

std::string options_with(const std::string& options, std::uint64_t mask) {
  return fmt::format("{} -DKDRAY_FEATURES={:#018x}ul", options, mask);
}

bool covers(std::uint64_t mask, const Variant& wanted) {
  return (mask & wanted.mask) == wanted.mask && (mask & ~wanted.mask & ~wanted.spare) == 0;
}

std::vector<std::uint64_t> covering(std::vector<std::uint64_t> masks, const Variant& wanted) {
  std::erase_if(masks, [&](std::uint64_t mask) { return !covers(mask, wanted); });
  std::ranges::sort(masks, {}, [](std::uint64_t mask) { return std::pair(std::popcount(mask), mask); });
  return masks;
}

namespace {

// How many programs of a family are made for just what was wanted. The next that is needed is made for all
// that any scene could want.
constexpr std::size_t kOwnPrograms = 2;

// Looks through the cache for a program that serves.
class Search {
 public:
  Search(const cl::Context& context, const std::vector<cl::Device>& devices, const std::string& source,
         const Variant& wanted, const ProgramCache& cache)
      : context_(context), devices_(devices), source_(source), wanted_(wanted), cache_(cache) {}

  std::optional<BuiltVariant> exact(const std::string& options, std::uint64_t mask) const {
    const std::string whole = options_with(options, mask);
    const auto program =
        cache_.find(context_, devices_, variant_key(identity_, source_, options, mask), whole);
    if (!program) return std::nullopt;
    return BuiltVariant{*program, mask, false};
  }

  std::optional<BuiltVariant> covering_one() const {
    for (const std::string* options : choices())
      for (const std::uint64_t mask : covering(cache_.masks_of(family(*options)), wanted_))
        if (auto found = exact(*options, mask)) return found;
    return std::nullopt;
  }

  // Returns the mask to compile for, where nothing serves.
  std::uint64_t mask_to_build() const {
    const std::uint64_t everything = wanted_.mask | wanted_.spare;
    const auto n = std::ranges::count_if(cache_.masks_of(family(wanted_.options)), [&](std::uint64_t mask) {
      return (mask | wanted_.spare) == everything && !covers(mask, wanted_);
    });
    return static_cast<std::size_t>(n) < kOwnPrograms ? wanted_.mask : everything;
  }

  ProgramKey key(std::uint64_t mask) const { return variant_key(identity_, source_, wanted_.options, mask); }

 private:
  std::uint64_t family(const std::string& options) const { return family_of(identity_, source_, options); }
  std::vector<const std::string*> choices() const {
    std::vector<const std::string*> all{&wanted_.options};
    for (const std::string& options : wanted_.instead) all.push_back(&options);
    return all;
  }

  const cl::Context& context_;
  const std::vector<cl::Device>& devices_;
  const std::string& source_;
  const Variant& wanted_;
  const ProgramCache& cache_;
  const std::string identity_ = identity_of(devices_.front());
};

}  // namespace

BuiltVariant build_variant(const cl::Context& context, const std::vector<cl::Device>& devices,
                           const std::string& file, const Variant& wanted, const Builds& builds) {
  const std::string source = expand_source(file);
  const auto compiled = [&](std::uint64_t mask, const ProgramKey& key) {
    return BuiltVariant{
        compile_source(context, devices, file, source, options_with(wanted.options, mask), key, builds), mask,
        true};
  };
  return checked("building " + file, [&] {
    if (!builds.cache) return compiled(wanted.mask, Hash{});
    const Search search(context, devices, source, wanted, *builds.cache);
    std::optional<BuiltVariant> found = search.exact(wanted.options, wanted.mask);
    if (!found && !builds.exact) found = search.covering_one();
    if (found) return *found;
    const std::uint64_t mask = builds.exact ? wanted.mask : search.mask_to_build();
    return compiled(mask, search.key(mask));
  });
}

}  // namespace kdray::device
