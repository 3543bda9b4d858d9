#include "base/signals.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <system_error>
#include <thread>

#include "base/temporary.h"

namespace kdray {

namespace {

// Returns the signals that end the program, but for those that it was told to ignore, as nohup does with
// SIGHUP.
sigset_t ending_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) sigaddset(&set, signal);
  }
  return set;
}

[[noreturn]] void die_of(int signal) {
  ::signal(signal, SIG_DFL);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  ::raise(signal);
  ::_exit(128 + signal);  // as a shell would tell of it; not reached
}

void unblock(const sigset_t& set) {
  ::pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

void wait_for(const sigset_t& set) {
  int signal = 0;
  while (::sigwait(&set, &signal) != 0) {
  }
  remove_temporaries();
  die_of(signal);
}

}  // namespace

void mind_signals() {
  const sigset_t set = ending_signals();
  ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
  try {
    std::thread(wait_for, set).detach();
  } catch (const std::system_error&) {  // too little memory for a thread: signals do as they ever did
    unblock(set);
  }
  // A file that gets larger than `ulimit -f` allows is then an error of writing, which is reported.
  ::signal(SIGXFSZ, SIG_IGN);
}

void leave_signals_alone() {
  unblock(ending_signals());
}

}  // namespace kdray
