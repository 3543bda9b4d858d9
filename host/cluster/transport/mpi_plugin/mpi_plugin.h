/* What    What kdray asks of libkdray-mpi.so, the plugin through which it speaks MPI: functions, in C.
   Shape   kdray_mpi() gives the table of them, or NULL where the plugin doesn't know the version that is
           asked for. Functions that can fail return a negative number then, and error() says why.
   Threads One at a time, which need not be the one that opened it (MPI_THREAD_SERIALIZED). */
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define KDRAY_MPI_VERSION 1
#define KDRAY_MPI_ENTRY "kdray_mpi"

struct kdray_mpi_functions {
  uint32_t version; /* KDRAY_MPI_VERSION */
  uint32_t bytes;   /* of this struct */
  int (*open)(void);
  int (*rank)(void);
  int (*ranks)(void);
  const char* (*library)(void); /* the MPI that it was built for, in words */
  const char* (*error)(void);   /* what went wrong last */

  /* The bytes have to stay as they are until sent() has returned `ticket`. */
  int (*send)(int to, int tag, const void* bytes, size_t n, uint64_t ticket);
  /* 1: a message whose bytes may go; 0: none. */
  int (*sent)(uint64_t* ticket);
  /* 1: a message is coming, which receive() has to take before the next is asked for; 0: none. */
  int (*probe)(int* from, int* tag, size_t* n);
  /* Begins to write it there; it has come when received() has returned `ticket`. */
  int (*receive)(void* to, uint64_t ticket);
  /* 1: a message that has come; 0: none. */
  int (*received)(uint64_t* ticket);

  int (*close)(void); /* all ranks have to */
  void (*abort)(int exit_code);
};

typedef const struct kdray_mpi_functions* (*kdray_mpi_entry)(uint32_t version);

#ifdef __cplusplus
}
#endif
