// What    The boundary of C and C++: exceptions become statuses, structs that grow and arrays become C++'s.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string>
#include <type_traits>

#include "kdray.h"
#include "kdray/kdray.h"

// What the opaque handles of kdray.h are.
struct kdray_scene {
  kdray::Scene scene;
  kdray::CommitReport report;  // of the last commit
};
struct kdray_cancel {
  kdray::Cancel cancel;
};
struct kdray_all_hits {
  kdray::AllHits hits;
};

namespace kdray::capi {

// The message of the thread's last failure.
std::string& last_error();

// Runs work(); its exceptions become a status and a message.
template <class Work>
kdray_status guarded(const Work& work) noexcept {
  const auto failed = [](kdray_status status, const char* message) {
    try {
      last_error() = message;
    } catch (...) {  // there is no memory for a message
    }
    return status;
  };
  try {
    work();
    return KDRAY_OK;
  } catch (const Error& error) {
    return failed(static_cast<kdray_status>(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    return failed(KDRAY_OUT_OF_MEMORY, "out of memory");
  } catch (const std::exception& error) {
    return failed(KDRAY_INTERNAL, error.what());
  } catch (...) {
    return failed(KDRAY_INTERNAL, "an unknown error");
  }
}

[[noreturn]] void refuse(const std::string& what);

// The struct as this library knows it: what an older program's doesn't have is 0. `name` is the parameter's.
template <class Struct>
Struct grown(const Struct* given, const char* name) {
  Struct whole{};
  if (given == nullptr) return whole;
  constexpr std::size_t kLargest = 65536;  // more is no struct's, but what lay in memory
  if (given->size < sizeof(std::size_t) || given->size > kLargest)
    refuse(std::string(name) + ": its size is not set");
  std::memcpy(&whole, given, std::min(given->size, sizeof whole));
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  if (given->size > sizeof whole &&
      std::any_of(bytes + sizeof whole, bytes + given->size, [](unsigned char byte) { return byte != 0; }))
    refuse(std::string(name) + ": has something that this version of kdray doesn't know");
  return whole;
}

template <class Pointer>
Pointer* needed(Pointer* pointer, const char* name) {
  if (pointer == nullptr) refuse(std::string(name) + " is NULL");
  return pointer;
}

template <class T>
constexpr std::int32_t kTypeOf = std::is_same_v<T, float>           ? KDRAY_FLOAT32
                                 : std::is_same_v<T, double>        ? KDRAY_FLOAT64
                                 : std::is_same_v<T, std::uint32_t> ? KDRAY_UINT32
                                 : std::is_same_v<T, std::int32_t>  ? KDRAY_INT32
                                 : std::is_same_v<T, std::uint64_t> ? KDRAY_UINT64
                                 : std::is_same_v<T, std::int64_t>  ? KDRAY_INT64
                                                                    : KDRAY_UINT8;

// "float32 or float64": what an array may be of.
template <class... Types>
std::string types_in_words() {
  constexpr const char* kNames[] = {"", "float32", "float64", "uint32", "int32", "uint64", "int64", "uint8"};
  std::string words;
  ((words += (words.empty() ? "" : " or ") + std::string(kNames[kTypeOf<std::remove_const_t<Types>>])), ...);
  return words;
}

// A view of C as one of C++: View is Rows<N, Types...>, Given kdray_in or kdray_out.
template <std::size_t N, class... Types, class Given>
Rows<N, Types...> rows_of(Rows<N, Types...>*, const Given& given, const char* name) {
  Rows<N, Types...> rows;
  if (given.count == 0) return rows;
  const auto fault = [name](const std::string& what) {
    return Error(ErrorCode::input, std::string(name) + ": " + what);
  };
  if (given.data == nullptr) throw fault("the data is NULL");
  const bool known = ([&] {
    if (given.type != kTypeOf<std::remove_const_t<Types>>) return false;
    const std::size_t stride = given.stride == 0                ? N * sizeof(Types)
                               : given.stride == KDRAY_SAME_ROW ? 0
                                                                : given.stride;
    try {
      rows = Rows<N, Types...>(static_cast<Types*>(given.data), given.count, stride);
    } catch (const Error& error) {
      throw fault(error.what());
    }
    return true;
  }() || ...);
  if (!known)
    throw fault("its type is " + std::to_string(given.type) + "; it is to be " + types_in_words<Types...>());
  return rows;
}
template <class View, class Given>
View view_of(const Given& given, const char* name) {
  return rows_of(static_cast<View*>(nullptr), given, name);
}

// Colours, vectors and cameras of kdray.h as C++'s.
inline Color color(const float (&c)[3]) {
  return {c[0], c[1], c[2]};
}

inline Vec3 vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}
// The same, or what three zeros stand for.
inline Vec3 vector_or(const double (&v)[3], const Vec3& none) {
  return vector(v) == Vec3{0, 0, 0} ? none : vector(v);
}

Camera camera_of(const kdray_camera* given);

}  // namespace kdray::capi
