# Writes OUT, a header with a hash of the files in SOURCES.
set(hashes)
foreach(source ${SOURCES})
  file(SHA256 ${source} hash)
  string(APPEND hashes ${hash})
endforeach()
string(SHA256 all "${hashes}")
file(WRITE ${OUT} "#define KDRAY_FINGERPRINT \"${all}\"\n")
