# cmake -DSOURCE=DIR -DOUT=FILE -P commit.cmake: writes a header with the commit that the source is of and its day, where
# there is a checkout and git; both are empty otherwise. A header that would be the same stays, and with it what includes it.
# "+" behind the commit says that files have changed since.
set(commit "")
set(date "")
find_program(git git)
if(git AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --abbrev=12 --exclude=* --dirty=+
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND ${git} -C ${SOURCE} log -1 --format=%cs OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
set(text "#define KDRAY_COMMIT \"${commit}\"\n#define KDRAY_COMMIT_DATE \"${date}\"\n")
if(EXISTS ${OUT})
  file(READ ${OUT} before)
endif()
if(NOT text STREQUAL before)
  file(WRITE ${OUT} "${text}")
endif()
