// What    libkdray-mpi.so: kdray's messages over MPI. It is all of kdray that is linked with MPI, and can be
//         built alone against any (docs/cluster.md).
// Shape   Two-sided messages of MPI 3.1 in a communicator of its own; nothing collective but at both ends.
//         Messages that come are matched when they are probed (MPI_Improbe), so that none can get between a
//         probe and its receive.
// Errors  MPI's are returned, and its text is kept for error().
#include "mpi_plugin.h"

#include <mpi.h>

#include <climits>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace {

// A message on its way out or in.
struct Moving {
  MPI_Request request;
  std::uint64_t ticket;
};

struct {
  MPI_Comm world = MPI_COMM_NULL;
  MPI_Message coming = MPI_MESSAGE_NULL;
  int coming_bytes = 0;
  std::vector<Moving> sending, receiving;
  std::string error, library;
  bool is_open = false;
} state;

// Returns whether it succeeded; a failure is noted.
bool went_well(int result, const char* what) {
  if (result == MPI_SUCCESS) return true;
  char text[MPI_MAX_ERROR_STRING] = "";
  int n = 0;
  if (MPI_Error_string(result, text, &n) != MPI_SUCCESS) n = 0;
  state.error = std::string(what) + ": " + std::string(text, static_cast<std::size_t>(n));
  return false;
}

int refuse(const char* why) {
  state.error = why;
  return -1;
}

int open_mpi() {
  if (state.is_open) return refuse("it is open already");
  int ready = 0, given = 0;
  if (!went_well(MPI_Initialized(&ready), "MPI_Initialized")) return -1;
  if (ready != 0) return refuse("MPI was in use before kdray opened it");
  if (!went_well(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given), "MPI_Init_thread"))
    return -1;
  if (given < MPI_THREAD_SERIALIZED)
    return refuse("this MPI can't be called from another thread than its first");
  if (!went_well(MPI_Comm_dup(MPI_COMM_WORLD, &state.world), "MPI_Comm_dup") ||
      !went_well(MPI_Comm_set_errhandler(state.world, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler") ||
      !went_well(MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN), "MPI_Comm_set_errhandler"))
    return -1;
  state.is_open = true;
  return 0;
}

int rank_of_this() {
  int rank = -1;
  return went_well(MPI_Comm_rank(state.world, &rank), "MPI_Comm_rank") ? rank : -1;
}

int number_of_ranks() {
  int n = -1;
  return went_well(MPI_Comm_size(state.world, &n), "MPI_Comm_size") ? n : -1;
}

// Returns the first line of the MPI's description; some have a whole page.
const char* library_in_words() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int n = 0;
  if (MPI_Get_library_version(text, &n) != MPI_SUCCESS) n = 0;
  state.library.assign(text, static_cast<std::size_t>(n));
  state.library.resize(std::strcspn(state.library.c_str(), "\n,"));
  return state.library.c_str();
}

const char* last_error() {
  return state.error.c_str();
}

int send_bytes(int to, int tag, const void* bytes, std::size_t n, std::uint64_t ticket) {
  if (n > INT_MAX) return refuse("a message of over 2 GiB");
  MPI_Request request = MPI_REQUEST_NULL;
  if (!went_well(MPI_Isend(bytes, static_cast<int>(n), MPI_BYTE, to, tag, state.world, &request),
                 "MPI_Isend"))
    return -1;
  state.sending.push_back({request, ticket});
  return 0;
}

// Finds a transfer that has ended, and takes it off the list.
int next_ended(std::vector<Moving>& list, std::uint64_t* ticket) {
  for (Moving& moving : list) {
    int done = 0;
    if (!went_well(MPI_Test(&moving.request, &done, MPI_STATUS_IGNORE), "MPI_Test")) return -1;
    if (done == 0) continue;
    *ticket = moving.ticket;
    moving = list.back();
    list.pop_back();
    return 1;
  }
  return 0;
}

int next_sent(std::uint64_t* ticket) {
  return next_ended(state.sending, ticket);
}

int next_received(std::uint64_t* ticket) {
  return next_ended(state.receiving, ticket);
}

int next_coming(int* from, int* tag, std::size_t* n) {
  if (state.coming != MPI_MESSAGE_NULL) return refuse("the last message was not received");
  MPI_Status status;
  int found = 0;
  if (!went_well(MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, state.world, &found, &state.coming, &status),
                 "MPI_Improbe"))
    return -1;
  if (found == 0) return 0;
  if (!went_well(MPI_Get_count(&status, MPI_BYTE, &state.coming_bytes), "MPI_Get_count")) return -1;
  if (state.coming_bytes == MPI_UNDEFINED || state.coming_bytes < 0) return refuse("a message of over 2 GiB");
  *from = status.MPI_SOURCE;
  *tag = status.MPI_TAG;
  *n = static_cast<std::size_t>(state.coming_bytes);
  return 1;
}

int receive_bytes(void* to, std::uint64_t ticket) {
  if (state.coming == MPI_MESSAGE_NULL) return refuse("no message was found");
  MPI_Request request = MPI_REQUEST_NULL;
  if (!went_well(MPI_Imrecv(to, state.coming_bytes, MPI_BYTE, &state.coming, &request), "MPI_Imrecv"))
    return -1;
  state.coming = MPI_MESSAGE_NULL;
  state.receiving.push_back({request, ticket});
  return 0;
}

int close_mpi() {
  if (!state.is_open) return 0;
  state.is_open = false;
  for (Moving& sending : state.sending)
    if (!went_well(MPI_Wait(&sending.request, MPI_STATUS_IGNORE), "MPI_Wait")) return -1;
  state.sending.clear();
  if (!went_well(MPI_Comm_free(&state.world), "MPI_Comm_free")) return -1;
  return went_well(MPI_Finalize(), "MPI_Finalize") ? 0 : -1;
}

void abort_mpi(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
}

constexpr kdray_mpi_functions kFunctions = {.version = KDRAY_MPI_VERSION,
                                            .bytes = sizeof(kdray_mpi_functions),
                                            .open = open_mpi,
                                            .rank = rank_of_this,
                                            .ranks = number_of_ranks,
                                            .library = library_in_words,
                                            .error = last_error,
                                            .send = send_bytes,
                                            .sent = next_sent,
                                            .probe = next_coming,
                                            .receive = receive_bytes,
                                            .received = next_received,
                                            .close = close_mpi,
                                            .abort = abort_mpi};

}  // namespace

extern "C" __attribute__((visibility("default"))) const kdray_mpi_functions* kdray_mpi(
    std::uint32_t version) {
  return version == KDRAY_MPI_VERSION ? &kFunctions : nullptr;
}
