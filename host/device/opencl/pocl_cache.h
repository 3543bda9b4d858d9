// What    Tells PoCL, before it begins, to compile a kernel once for work-groups of any size, and chooses the
//         folder that it compiles in: one that can be written, has space and may hold programs.
// Why     Without such a folder PoCL offers no device at all, or fails while it compiles, or it or LLVM ends
//         the process. No home, or one that is read-only, full or mounted with noexec, is common: containers,
//         services, batch systems, clusters.
// Shape   PoCL's own choice where it will do; else in kdray's cache folder; else a temporary folder (in
//         TMPDIR, XDG_RUNTIME_DIR or /dev/shm), which goes with the process, so that the next one compiles
//         anew.
// Threads The first call sets environment variables (POCL_WORK_GROUP_SPECIALIZATION, POCL_CACHE_DIR,
//         HWLOC_PLUGINS_PATH), which no other thread may read meanwhile, and comes before OpenCL's first.
#pragma once

#include <filesystem>
#include <string>

namespace kdray::device {

struct PoclCache {
  std::filesystem::path folder;     // that PoCL uses
  std::filesystem::path preferred;  // that it would have used: another one where that can't be used
  std::string why_not;              // the reason; empty: there was none
  bool temporary = false;
  std::string unusable;  // why none of them will do, with what to do about it; empty where one does
};

// Returns the folder; the first call chooses it.
const PoclCache& pocl_cache();

bool is_pocl(const std::string& platform);

// Returns why PoCL can't compile in the folder, which need not exist yet; an empty text when it can.
std::string why_no_cache(const std::filesystem::path& folder);

}  // namespace kdray::device
