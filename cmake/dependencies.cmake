# What kdray is built from; all of it Debian packages (scripts/dependencies lists them). Nothing is downloaded.
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)
find_package(OpenCL REQUIRED)          # ocl-icd-opencl-dev, opencl-clhpp-headers
find_package(glm REQUIRED)             # libglm-dev
find_package(TBB REQUIRED)             # libtbb-dev
find_package(CLI11 REQUIRED)           # libcli11-dev
find_package(fmt REQUIRED)             # libfmt-dev
find_package(nlohmann_json REQUIRED)   # nlohmann-json3-dev
find_package(PNG REQUIRED)             # libpng-dev
find_package(ZLIB REQUIRED)            # zlib1g-dev
find_package(LibLZMA REQUIRED)         # liblzma-dev
find_package(PkgConfig REQUIRED)       # pkg-config; Debian's OpenEXR config file wants packages nobody needs
pkg_check_modules(OpenEXR REQUIRED IMPORTED_TARGET OpenEXR)  # libopenexr-dev
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)  # libxxhash-dev
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)  # libhwy-dev
find_package(assimp QUIET)             # libassimp-dev, optional: mesh formats without a reader of our own
# Optional: libboost-dev (Beast and Asio, headers alone) with libturbojpeg0-dev for `kdray view`, which says what is missing;
# libturbojpeg0-dev alone for JPEG pictures on surfaces.
find_package(Boost 1.74 CONFIG QUIET)
pkg_check_modules(turbojpeg QUIET IMPORTED_TARGET libturbojpeg)
if(Boost_FOUND AND turbojpeg_FOUND)
  set(KDRAY_CAN_VIEW ON)
else()
  set(KDRAY_CAN_VIEW OFF)
endif()
# Optional: what glTF files may be packed with (host/scene/import/load.cpp tells users which of them are there).
find_package(draco CONFIG QUIET)                       # libdraco-dev; Debian 13's pkg-config file is broken
find_package(meshoptimizer CONFIG QUIET)               # libmeshoptimizer-dev
pkg_check_modules(webp QUIET IMPORTED_TARGET libwebp)  # libwebp-dev
if(KDRAY_TESTS)
  find_package(GTest REQUIRED)         # libgtest-dev, libgmock-dev
  pkg_check_modules(gmpxx REQUIRED IMPORTED_TARGET gmpxx)  # libgmp-dev: the stress suite's exact arithmetic
endif()
