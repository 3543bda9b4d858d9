# KDRAY_KINDS: the kinds of primitives, and KDRAY_SHAPES, all but triangles; named in lower case as their files are. From the
# list in kernels/layout/kinds.h, so that a new kind's files are found by their names.
set(kinds_list ${PROJECT_SOURCE_DIR}/kernels/layout/kinds.h)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${kinds_list})
file(READ ${kinds_list} kinds_text)
string(REGEX MATCHALL "F\\(X, [A-Z]+, [a-z]+," KDRAY_KINDS "${kinds_text}")
list(TRANSFORM KDRAY_KINDS REPLACE "F\\(X, [A-Z]+, ([a-z]+)," "\\1")
set(KDRAY_SHAPES ${KDRAY_KINDS})
list(REMOVE_ITEM KDRAY_SHAPES triangle)

# kdray_files_of(OUT KINDS PATTERNS...): the files of each of the kinds by patterns with KIND for its name.
function(kdray_files_of out kinds)
  set(files)
  foreach(kind ${kinds})
    list(TRANSFORM ARGN REPLACE "KIND" ${kind} OUTPUT_VARIABLE of_kind)
    list(APPEND files ${of_kind})
  endforeach()
  set(${out} ${files} PARENT_SCOPE)
endfunction()
