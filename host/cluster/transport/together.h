// What    Steps that all ranks take together: each gives bytes for each of the others, each gives bytes for
//         all, or what they have is joined into one.
// Shape   All ranks make the same calls in the same order, with one Together for the whole run. Steps are
//         numbered, and what comes early is kept, so that messages may come in any order. A rank begins no
//         step before it has what the step before has for it: so at most two steps' messages of each rank
//         are on their way.
// Why     Sums that don't depend on an order (whole numbers, least and largest) are the same bits for any
//         number of ranks.
// Errors  ErrorCode::internal for a message that makes no sense; and those of Ranks::wait(), by which a rank
//         that can't go on ends the waiting of all.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "cluster/transport/ranks.h"

namespace kdray::transport {

class Together {
 public:
  explicit Together(Ranks& ranks) : ranks_(ranks) {}

  int rank() const { return ranks_.rank(); }
  int size() const { return ranks_.size(); }
  bool leads() const { return ranks_.leads(); }

  // Gives each rank its entry of `out`, and returns what each rank has given this one.
  std::vector<Bytes> exchange(std::vector<Bytes> out);

  // Gives `own` to all ranks, and returns what each rank has given.
  std::vector<Bytes> gather(Bytes own);

  // Joins what all ranks have by `join(Bytes& all, const Bytes& one)`, in the order of ranks. The bytes of
  // all ranks and the result have the same length.
  template <class Join>
  Bytes join(Bytes own, const Join& join);

  // Does the same with plain values: join(T& all, const T& one).
  template <class T, class Join>
  T join_values(const T& own, const Join& join);
  // Does the same with lists of them, value by value, in place.
  template <class T, class Join>
  void join_lists(std::span<T> own, const Join& join);

  template <class T>
  T sum(const T& own) {
    return join_values(own, [](T& all, const T& one) { all += one; });
  }
  template <class T>
  T most(const T& own) {
    return join_values(own, [](T& all, const T& one) { all = one > all ? one : all; });
  }
  bool any(bool own) { return most(static_cast<std::uint8_t>(own)) != 0; }

 private:
  std::uint32_t begin() { return ++step_; }
  void send(int to, std::uint32_t step, Bytes bytes);
  Bytes receive(int from, std::uint32_t step);

  Ranks& ranks_;
  std::uint32_t step_ = 0;
  std::map<std::pair<std::uint32_t, int>, Bytes> early_;
};

template <class T>
Bytes bytes_of_list(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return Bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
}

[[noreturn]] void throw_odd_message(int from);

// Lists of plain values in the bytes of a message, one behind the other, as they lie in memory: all ranks run
// the same build.
class WireWriter {
 public:
  explicit WireWriter(Bytes& bytes) : bytes_(bytes) {}

  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  // Puts those at these places.
  template <class List, class Places>
  void put_some(const List& values, const Places& places) {
    bytes_.reserve(bytes_.size() + places.size() * sizeof(values[0]));
    for (const auto place : places) put(values[place]);
  }

 private:
  Bytes& bytes_;
};

// Throws ErrorCode::internal where a message is shorter or longer than what is taken from it.
class WireReader {
 public:
  WireReader(const Bytes& bytes, int from) : bytes_(bytes), from_(from) {}

  template <class T>
  T get() {
    T value;
    std::memcpy(static_cast<void*>(&value), next(sizeof(T)), sizeof(T));
    return value;
  }
  // Reads n values into `to`, which has memory for them.
  template <class T>
  void get_all(T* to, std::size_t n) {
    if (n > left() / sizeof(T)) throw_odd_message(from_);
    const char* const first = next(n * sizeof(T));
    if (n > 0) std::memcpy(static_cast<void*>(to), first, n * sizeof(T));
  }
  // Reads n values and appends them to the list.
  template <class List>
  void take(List& list, std::size_t n) {
    using T = typename List::value_type;
    if (n > left() / sizeof(T)) throw_odd_message(from_);
    const std::size_t before = list.size();
    list.resize(before + n);
    get_all(list.data() + before, n);
  }
  void end() const {
    if (left() != 0) throw_odd_message(from_);
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  const char* next(std::size_t n) {
    if (n > left()) throw_odd_message(from_);
    at_ += n;
    return bytes_.data() + at_ - n;
  }

  const Bytes& bytes_;
  int from_;
  std::size_t at_ = 0;
};

template <class Join>
Bytes Together::join(Bytes own, const Join& join) {
  const std::uint32_t step = begin();
  if (size() == 1) return own;
  if (!leads()) {
    send(0, step, std::move(own));
    return receive(0, step);
  }
  for (int from = 1; from < size(); ++from) {
    const Bytes one = receive(from, step);
    if (one.size() != own.size()) throw_odd_message(from);
    join(own, one);
  }
  for (int to = 1; to < size(); ++to) send(to, step, own);
  return own;
}

template <class T, class Join>
void Together::join_lists(std::span<T> own, const Join& join_one) {
  const Bytes all = join(bytes_of_list<T>(own), [&](Bytes& sum, const Bytes& bytes) {
    for (std::size_t i = 0; i < own.size(); ++i) {
      T a, b;
      std::memcpy(&a, sum.data() + i * sizeof(T), sizeof(T));
      std::memcpy(&b, bytes.data() + i * sizeof(T), sizeof(T));
      join_one(a, b);
      std::memcpy(sum.data() + i * sizeof(T), &a, sizeof(T));
    }
  });
  if (all.size() != own.size_bytes()) throw_odd_message(0);
  if (!own.empty()) std::memcpy(static_cast<void*>(own.data()), all.data(), all.size());
}

template <class T, class Join>
T Together::join_values(const T& own, const Join& join_one) {
  T all = own;
  join_lists(std::span<T>(&all, 1), join_one);
  return all;
}

}  // namespace kdray::transport
