// What    An environment variable for the length of a scope; what it was before comes back.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace kdray::test {

class Variable {
 public:
  explicit Variable(const char* name) : name_(name) {
    if (const char* value = std::getenv(name)) before_ = value;
    ::unsetenv(name);
  }
  Variable(const char* name, const std::string& value) : Variable(name) { ::setenv(name, value.c_str(), 1); }
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

}  // namespace kdray::test
