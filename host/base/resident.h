// What    How much of mapped files this process has in memory.
// Source  proc(5): statm, smaps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>

namespace kdray {

// Of all files that are mapped; takes microseconds. 0 where the system doesn't tell.
std::uint64_t resident_of_files();

// Of these ranges, each by its first byte and its size, whole mappings of their own or the inner part of one
// (which counts by what the whole has, and no more than its size). Takes milliseconds for many gigabytes.
std::uint64_t resident_of(const std::map<void*, std::size_t>& ranges);

}  // namespace kdray
