// What    Embree 3 and 4 behind one interface: a query (what a thread hands over besides scene and rays), and
//         calls for one ray, 8, 16 and a stream, closest and any hit, by number of rays.
// Shape   Rays are Embree's own structs, N rays to one, seen through its RTCRayN accessors. KDRAY_EMBREE is
//         the major version that was found. Embree 4 has no streams.
#pragma once

#if KDRAY_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace kdray::bench {

inline constexpr bool kHasStreams = KDRAY_EMBREE == 3;
inline constexpr unsigned kStreamPackets = 16;  // of 16 rays

template <unsigned N>
struct Packet;
template <>
struct Packet<1> {
  using ClosestRay = RTCRayHit;
  using AnyRay = RTCRay;
};
template <>
struct Packet<8> {
  using ClosestRay = RTCRayHit8;
  using AnyRay = RTCRay8;
};
template <>
struct Packet<16> {
  using ClosestRay = RTCRayHit16;
  using AnyRay = RTCRay16;
};

#if KDRAY_EMBREE == 4

using CallContext = RTCRayQueryContext;

class Query {
 public:
  // What filters find of a call: Embree's own, and what it was made with.
  struct Context {
    CallContext embrees;
    void* user;
  };

  explicit Query(bool coherent, void* user = nullptr) {
    const RTCRayQueryFlags flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcInitIntersectArguments(&closest_);
    rtcInitOccludedArguments(&any_);
    closest_.flags = any_.flags = flags;
    rtcInitRayQueryContext(&context_.embrees);
    context_.user = user;
    if (user != nullptr) closest_.context = any_.context = &context_.embrees;
  }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  void trace(RTCScene s, const int*, RTCRayHit* rays) { rtcIntersect1(s, rays, &closest_); }
  void trace(RTCScene s, const int* valid, RTCRayHit8* rays) { rtcIntersect8(valid, s, rays, &closest_); }
  void trace(RTCScene s, const int* valid, RTCRayHit16* rays) { rtcIntersect16(valid, s, rays, &closest_); }
  void trace(RTCScene s, const int*, RTCRay* rays) { rtcOccluded1(s, rays, &any_); }
  void trace(RTCScene s, const int* valid, RTCRay8* rays) { rtcOccluded8(valid, s, rays, &any_); }
  void trace(RTCScene s, const int* valid, RTCRay16* rays) { rtcOccluded16(valid, s, rays, &any_); }
  void stream(RTCScene, RTCRayHit16*, unsigned) {}  // never called: kHasStreams
  void stream(RTCScene, RTCRay16*, unsigned) {}

 private:
  Context context_;
  RTCIntersectArguments closest_;
  RTCOccludedArguments any_;
};

#else

using CallContext = RTCIntersectContext;

class Query {
 public:
  struct Context {
    CallContext embrees;
    void* user;
  };

  explicit Query(bool coherent, void* user = nullptr) : context_{{}, user} {
    rtcInitIntersectContext(&context_.embrees);
    context_.embrees.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  void trace(RTCScene s, const int*, RTCRayHit* rays) { rtcIntersect1(s, &context_.embrees, rays); }
  void trace(RTCScene s, const int* valid, RTCRayHit8* rays) {
    rtcIntersect8(valid, s, &context_.embrees, rays);
  }
  void trace(RTCScene s, const int* valid, RTCRayHit16* rays) {
    rtcIntersect16(valid, s, &context_.embrees, rays);
  }
  void trace(RTCScene s, const int*, RTCRay* rays) { rtcOccluded1(s, &context_.embrees, rays); }
  void trace(RTCScene s, const int* valid, RTCRay8* rays) { rtcOccluded8(valid, s, &context_.embrees, rays); }
  void trace(RTCScene s, const int* valid, RTCRay16* rays) {
    rtcOccluded16(valid, s, &context_.embrees, rays);
  }
  void stream(RTCScene s, RTCRayHit16* rays, unsigned n_packets) {
    rtcIntersectNM(s, &context_.embrees, reinterpret_cast<RTCRayHitN*>(rays), 16, n_packets,
                   sizeof(RTCRayHit16));
  }
  void stream(RTCScene s, RTCRay16* rays, unsigned n_packets) {
    rtcOccludedNM(s, &context_.embrees, reinterpret_cast<RTCRayN*>(rays), 16, n_packets, sizeof(RTCRay16));
  }

 private:
  Context context_;
};

#endif

// In a filter: what the Query was made with.
inline void* user_of(const RTCFilterFunctionNArguments* args) {
  return reinterpret_cast<const Query::Context*>(args->context)->user;
}

}  // namespace kdray::bench
