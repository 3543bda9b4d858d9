#include "arrays.h"

#include <type_traits>

#include "kdray/error.h"

namespace kdray::python {

namespace {

namespace nb = nanobind;

// The view of an array whose values are of one of `Types`.
template <class Rows, class Array, class... Types>
Rows view(const std::optional<Array>& given) {
  if (!given || given->shape(0) == 0) return {};
  const Array& array = *given;
  const std::size_t values = array.ndim() == 2 ? array.shape(1) : 1;
  const bool side_by_side = array.ndim() < 2 || array.stride(1) == 1 || array.shape(1) == 1;
  if (array.ndim() < 1 || array.ndim() > 2 || values != Rows::kValues || !side_by_side || array.stride(0) < 0)
    throw Error(ErrorCode::internal, "an array of this shape can't be seen as rows");
  std::optional<Rows> rows;
  const auto try_type = [&]<class T>(T*) {
    using Held =
        std::conditional_t<std::is_const_v<std::remove_pointer_t<decltype(array.data())>>, const T, T>;
    if (!rows && array.dtype() == nb::dtype<T>())
      rows.emplace(static_cast<Held*>(array.data()), array.shape(0),
                   static_cast<std::size_t>(array.stride(0)) * sizeof(T));
  };
  (try_type(static_cast<Types*>(nullptr)), ...);
  if (!rows) throw Error(ErrorCode::internal, "an array of this type can't be seen as rows");
  return *rows;
}

}  // namespace

Points points_of(const In& array) {
  return view<Points, In::value_type, float, double>(array);
}
Pairs pairs_of(const In& array) {
  return view<Pairs, In::value_type, float, double>(array);
}
Transforms transforms_of(const In& array) {
  return view<Transforms, In::value_type, float, double>(array);
}
Values values_of(const In& array) {
  return view<Values, In::value_type, float, double>(array);
}
Triples triples_of(const In& array) {
  return view<Triples, In::value_type, std::uint32_t, std::int32_t, std::uint64_t, std::int64_t>(array);
}
Words words_of(const In& array) {
  return view<Words, In::value_type, std::uint32_t>(array);
}
PointsOut points_out(const Out& array) {
  return view<PointsOut, Out::value_type, float, double>(array);
}
ValuesOut values_out(const Out& array) {
  return view<ValuesOut, Out::value_type, float, double>(array);
}
WordsOut words_out(const Out& array) {
  return view<WordsOut, Out::value_type, std::uint32_t>(array);
}
BytesOut bytes_out(const Out& array) {
  return view<BytesOut, Out::value_type, std::uint8_t>(array);
}

}  // namespace kdray::python
