// What    The one exception type of kdray: a code (the process's exit status), where, what and what to do.
// Errors  Thrown by every module; caught only by the API edge and the command line.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

namespace kdray {

// Exit statuses of the command line (docs/cli.md).
enum class ErrorCode { input = 1, usage = 2, no_device = 3, out_of_memory = 4, internal = 5, cancelled = 6 };

class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

// "file:line: what; what to do". line 0 = no line; an empty `remedy` is left out.
[[nodiscard]] Error input_error(const std::string& file, std::size_t line, const std::string& what,
                                const std::string& remedy = "");

}  // namespace kdray
