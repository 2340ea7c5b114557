// SPDX-License-Identifier: BSD-3-Clause
//
// Lanes in a plain loop, without Highway. Part of lanes.h.

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

template <typename T, std::size_t N>
struct Lanes {
  T lane[N];
};

template <typename T, std::size_t N>
struct LaneMask {
  bool lane[N];
};

#define FCL_CCD_FOR_LANES for (std::size_t i = 0; i < N; ++i)

template <std::size_t N, typename T>
inline Lanes<T, N> load(const T* from) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = from[i];
  return out;
}

template <std::size_t N, typename T>
inline Lanes<T, N> broadcast(T value) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = value;
  return out;
}

template <typename T, std::size_t N>
inline void store(const Lanes<T, N>& a, T* to) {
  FCL_CCD_FOR_LANES to[i] = a.lane[i];
}

#define FCL_CCD_LANEWISE(NAME, RESULT, ARGUMENT, OP)                           \
  template <typename T, std::size_t N>                                         \
  inline RESULT<T, N> NAME(const ARGUMENT<T, N>& a, const ARGUMENT<T, N>& b) { \
    RESULT<T, N> out;                                                          \
    FCL_CCD_FOR_LANES out.lane[i] = a.lane[i] OP b.lane[i];                    \
    return out;                                                                \
  }
FCL_CCD_LANEWISE(operator+, Lanes, Lanes, +)
FCL_CCD_LANEWISE(operator-, Lanes, Lanes, -)
FCL_CCD_LANEWISE(operator*, Lanes, Lanes, *)
FCL_CCD_LANEWISE(operator/, Lanes, Lanes, /)
FCL_CCD_LANEWISE(operator==, LaneMask, Lanes, ==)
FCL_CCD_LANEWISE(operator<, LaneMask, Lanes, <)
FCL_CCD_LANEWISE(operator>, LaneMask, Lanes, >)
FCL_CCD_LANEWISE(operator<=, LaneMask, Lanes, <=)
FCL_CCD_LANEWISE(operator>=, LaneMask, Lanes, >=)
FCL_CCD_LANEWISE(operator&, LaneMask, LaneMask, &&)
FCL_CCD_LANEWISE(operator|, LaneMask, LaneMask, ||)
#undef FCL_CCD_LANEWISE

template <typename T, std::size_t N>
inline Lanes<T, N> abs(const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = std::abs(a.lane[i]);
  return out;
}

template <typename T, std::size_t N>
inline Lanes<T, N> squareRoot(const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = std::sqrt(a.lane[i]);
  return out;
}

template <typename T, std::size_t N>
inline Lanes<T, N> select(const LaneMask<T, N>& mask, const Lanes<T, N>& a,
                          const Lanes<T, N>& b) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = mask.lane[i] ? a.lane[i] : b.lane[i];
  return out;
}

template <typename T, std::size_t N>
inline unsigned bits(const LaneMask<T, N>& mask) {
  unsigned out = 0;
  FCL_CCD_FOR_LANES out |= unsigned{mask.lane[i]} << i;
  return out;
}

template <typename T, std::size_t N>
inline bool isAll(const LaneMask<T, N>& mask) {
  bool all = true;
  FCL_CCD_FOR_LANES all &= mask.lane[i];
  return all;
}

template <typename T, std::size_t N>
inline Lanes<T, N> swapHalves(const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = a.lane[(i + N / 2) % N];
  return out;
}

template <typename T, std::size_t N>
inline Lanes<T, N> larger(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i];
  return out;
}

template <typename T, std::size_t N>
inline Lanes<T, N> smaller(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i];
  return out;
}

template <typename T, std::size_t N>
inline Lanes<T, N> bothNegative(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  return larger(a, b);
}

template <typename T, std::size_t N>
inline Lanes<T, N> eitherNegative(const Lanes<T, N>& a, const Lanes<T, N>& b) {
  return smaller(a, b);
}

template <typename T, std::size_t N>
inline Lanes<T, N> whereNegative(const Lanes<T, N>& s, const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = s.lane[i] < 0 ? a.lane[i] : 0;
  return out;
}

template <typename T, std::size_t N>
inline unsigned signs(const Lanes<T, N>& a) {
  unsigned out = 0;
  FCL_CCD_FOR_LANES out |= unsigned{a.lane[i] < 0} << i;
  return out;
}

template <typename T, std::size_t N>
inline bool isAnyNegative(const Lanes<T, N>& a) {
  return signs(a) != 0;
}

template <std::size_t N>
inline Lanes<float, N> narrowed(const Lanes<double, N>& a) {
  Lanes<float, N> out;
  FCL_CCD_FOR_LANES out.lane[i] = static_cast<float>(a.lane[i]);
  return out;
}

inline void storeCounted(unsigned mask, std::uint32_t first, std::uint32_t* to) {
  assert(mask >> kSixteen == 0);
  for (; mask != 0; mask &= mask - 1)
    *to++ = first + static_cast<std::uint32_t>(lowestBit(mask));
}

inline void storeSelected(unsigned mask, const std::uint32_t* from, std::uint32_t* to) {
  assert(to <= from && mask >> kSixteen == 0);
  for (; mask != 0; mask &= mask - 1) *to++ = from[lowestBit(mask)];
}

template <typename T, std::size_t N>
inline T largest(const Lanes<T, N>& a) {
  T most = a.lane[0];
  FCL_CCD_FOR_LANES most = a.lane[i] > most ? a.lane[i] : most;
  return most;
}

template <typename Row, typename T, std::size_t N>
inline void loadColumns(const Row& row, Lanes<T, N>& x, Lanes<T, N>& y, Lanes<T, N>& z) {
  FCL_CCD_FOR_LANES {
    x.lane[i] = row(i)[0];
    y.lane[i] = row(i)[1];
    z.lane[i] = row(i)[2];
  }
}

template <typename Row, typename T, std::size_t N>
inline void loadColumns(const Row& row, Lanes<T, N>& x, Lanes<T, N>& y, Lanes<T, N>& z,
                        Lanes<T, N>& w) {
  loadColumns(row, x, y, z);
  FCL_CCD_FOR_LANES w.lane[i] = row(i)[3];
}

inline void loadTwoEach(const float* from, Lanes<double, kEight>& first,
                        Lanes<double, kEight>& second) {
  for (std::size_t i = 0; i < kEight; ++i) {
    first.lane[i] = double{from[2 * i]};
    second.lane[i] = double{from[2 * i + 1]};
  }
}

inline void transpose(Lanes<float, kEight> (&x)[kEight]) {
  for (std::size_t i = 0; i < kEight; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const float kept = x[i].lane[j];
      x[i].lane[j] = x[j].lane[i];
      x[j].lane[i] = kept;
    }
}

#undef FCL_CCD_FOR_LANES

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
