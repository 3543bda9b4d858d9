#include "api/names.h"

namespace kdray::api {

const char* name_of(Traversal traversal) {
  switch (traversal) {
    case Traversal::automatic:
      return "auto";
    case Traversal::binary:
      return "binary";
    case Traversal::wide:
      return "wide";
    case Traversal::packet:
      return "packet";
    case Traversal::batch:
      return "batch";
  }
  return "?";
}

const char* name_of(Precision precision) {
  return precision == Precision::float64 ? "double" : "float";
}

const char* name_of(Division division) {
  switch (division) {
    case Division::bag:
      return "bag";
    case Division::contiguous:
      return "contiguous";
    case Division::interleaved:
      return "interleaved";
  }
  return "?";
}

const char* name_of(Balance balance) {
  switch (balance) {
    case Balance::sah:
      return "sah";
    case Balance::pilot:
      return "pilot";
    case Balance::dynamic:
      return "dynamic";
  }
  return "?";
}

}  // namespace kdray::api
