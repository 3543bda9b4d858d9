// What    A kdray that runs beside the test, which may kill it.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <vector>

#include "support/patience.h"

namespace kdray::test {

class Running {
 public:
  // Its stderr goes to this file, behind what is there. Another program than kdray may be named, and
  // variables set.
  Running(const std::vector<std::string>& arguments, const std::string& log, const std::string& program = {},
          const std::map<std::string, std::string>& environment = {});
  ~Running();  // kills it, if need be
  Running(Running&& other) noexcept;
  Running& operator=(Running&&) = delete;

  void kill(int signal) const;
  bool has_ended();
  // False: it hadn't ended by then.
  bool wait(double seconds = kPatience);

  int code() const { return code_; }      // -1: none
  int signal() const { return signal_; }  // 0: none
  pid_t process() const { return process_; }
  std::vector<pid_t> children() const;

 private:
  pid_t process_;
  bool ended_ = false;
  int code_ = -1, signal_ = 0;
};

}  // namespace kdray::test
