// SPDX-License-Identifier: BSD-3-Clause
//
// Lanes in as many of Highway's vectors as they take. Part of lanes.h, which includes it
// once for each of Highway's targets that has vectors.

HWY_BEFORE_NAMESPACE();
namespace fcl {
namespace detail {
namespace deformable {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <typename T, std::size_t N>
struct Lanes {
  using Tag = hn::CappedTag<T, N>;
  static constexpr std::size_t kWidth = hn::MaxLanes(Tag());
  static constexpr std::size_t kParts = N / kWidth;
  hn::Vec<Tag> part[kParts];
};

template <typename T, std::size_t N>
struct LaneMask {
  hn::Mask<typename Lanes<T, N>::Tag> part[Lanes<T, N>::kParts];
};

#define FCL_CCD_FOR_PARTS for (std::size_t p = 0; p < Lanes<T, N>::kParts; ++p)

template <std::size_t N, typename T>
HWY_INLINE Lanes<T, N> load(const T* from) {
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS
  out.part[p] = hn::LoadU(typename Lanes<T, N>::Tag(), from + p * Lanes<T, N>::kWidth);
  return out;
}

template <std::size_t N, typename T>
HWY_INLINE Lanes<T, N> broadcast(T value) {
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS out.part[p] = hn::Set(typename Lanes<T, N>::Tag(), value);
  return out;
}

template <typename T, std::size_t N>
HWY_INLINE void store(const Lanes<T, N>& a, T* to) {
  FCL_CCD_FOR_PARTS
  hn::StoreU(a.part[p], typename Lanes<T, N>::Tag(), to + p * Lanes<T, N>::kWidth);
}

#define FCL_CCD_BINARY(NAME, OP)                                            \
  template <typename T, std::size_t N>                                      \
  HWY_INLINE Lanes<T, N> NAME(const Lanes<T, N>& a, const Lanes<T, N>& b) { \
    Lanes<T, N> out;                                                        \
    FCL_CCD_FOR_PARTS out.part[p] = hn::OP(a.part[p], b.part[p]);           \
    return out;                                                             \
  }
FCL_CCD_BINARY(operator+, Add)
FCL_CCD_BINARY(operator-, Sub)
FCL_CCD_BINARY(operator*, Mul)
FCL_CCD_BINARY(operator/, Div)
// The larger and the smaller of two numbers, neither of which is a NaN.
FCL_CCD_BINARY(larger, Max)
FCL_CCD_BINARY(smaller, Min)
// Negative where both numbers are negative, and where at least one is. No number is NaN
// or -0.
FCL_CCD_BINARY(bothNegative, And)
FCL_CCD_BINARY(eitherNegative, Or)
#undef FCL_CCD_BINARY

template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> abs(const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS out.part[p] = hn::Abs(a.part[p]);
  return out;
}

template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> squareRoot(const Lanes<T, N>& a) {
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS out.part[p] = hn::Sqrt(a.part[p]);
  return out;
}

#define FCL_CCD_COMPARISON(NAME, OP)                                           \
  template <typename T, std::size_t N>                                         \
  HWY_INLINE LaneMask<T, N> NAME(const Lanes<T, N>& a, const Lanes<T, N>& b) { \
    LaneMask<T, N> out;                                                        \
    FCL_CCD_FOR_PARTS out.part[p] = hn::OP(a.part[p], b.part[p]);              \
    return out;                                                                \
  }
FCL_CCD_COMPARISON(operator==, Eq)
FCL_CCD_COMPARISON(operator<, Lt)
FCL_CCD_COMPARISON(operator>, Gt)
FCL_CCD_COMPARISON(operator<=, Le)
FCL_CCD_COMPARISON(operator>=, Ge)
#undef FCL_CCD_COMPARISON

#define FCL_CCD_LOGICAL(NAME, OP)                                                    \
  template <typename T, std::size_t N>                                               \
  HWY_INLINE LaneMask<T, N> NAME(const LaneMask<T, N>& a, const LaneMask<T, N>& b) { \
    LaneMask<T, N> out;                                                              \
    FCL_CCD_FOR_PARTS out.part[p] = hn::OP(a.part[p], b.part[p]);                    \
    return out;                                                                      \
  }
FCL_CCD_LOGICAL(operator&, And)
FCL_CCD_LOGICAL(operator|, Or)
#undef FCL_CCD_LOGICAL

/// a where the mask is set, b elsewhere.
template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> select(const LaneMask<T, N>& mask, const Lanes<T, N>& a,
                              const Lanes<T, N>& b) {
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS
  out.part[p] = hn::IfThenElse(mask.part[p], a.part[p], b.part[p]);
  return out;
}

/// One bit a lane.
template <typename T, std::size_t N>
HWY_INLINE unsigned bits(const LaneMask<T, N>& mask) {
  unsigned out = 0;
  FCL_CCD_FOR_PARTS {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(typename Lanes<T, N>::Tag(), mask.part[p], bytes);
    out |= (bytes[0] | unsigned{bytes[1]} << 8) << (p * Lanes<T, N>::kWidth);
  }
  return out;
}

/// The two halves exchanged.
template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> swapHalves(const Lanes<T, N>& a) {
  constexpr std::size_t kParts = Lanes<T, N>::kParts;
  Lanes<T, N> out;
#if HWY_MAX_BYTES >= 64
  if constexpr (kParts == 1) {
    out.part[0] = hn::ConcatLowerUpper(typename Lanes<T, N>::Tag(), a.part[0], a.part[0]);
    return out;
  }
#endif
  FCL_CCD_FOR_PARTS out.part[p] = a.part[p ^ (kParts / 2)];
  return out;
}

/// The lanes whose sign bit is set. Compared as integers, since only the sign of the
/// result of bothNegative() has a meaning.
template <typename T, std::size_t N>
HWY_INLINE LaneMask<T, N> isNegative(const Lanes<T, N>& a) {
  const typename Lanes<T, N>::Tag tag;
  const hn::RebindToSigned<decltype(tag)> integers;
  LaneMask<T, N> out;
  FCL_CCD_FOR_PARTS
  out.part[p] =
      hn::RebindMask(tag, hn::Lt(hn::BitCast(integers, a.part[p]), hn::Zero(integers)));
  return out;
}

/// a where s is negative, 0 elsewhere.
template <typename T, std::size_t N>
HWY_INLINE Lanes<T, N> whereNegative(const Lanes<T, N>& s, const Lanes<T, N>& a) {
  const LaneMask<T, N> mask = isNegative(s);
  Lanes<T, N> out;
  FCL_CCD_FOR_PARTS out.part[p] = hn::IfThenElseZero(mask.part[p], a.part[p]);
  return out;
}

/// One bit a lane: its sign.
template <typename T, std::size_t N>
HWY_INLINE unsigned signs(const Lanes<T, N>& a) {
  return bits(isNegative(a));
}

/// Whether the sign bit of a lane is set.
template <typename T, std::size_t N>
HWY_INLINE bool isAnyNegative(const Lanes<T, N>& a) {
  auto any = a.part[0];
  for (std::size_t p = 1; p < Lanes<T, N>::kParts; ++p) any = hn::Or(any, a.part[p]);
  const typename Lanes<T, N>::Tag tag;
  const hn::RebindToSigned<decltype(tag)> integers;
  return !hn::AllFalse(integers, hn::Lt(hn::BitCast(integers, any), hn::Zero(integers)));
}

template <typename T, std::size_t N>
HWY_INLINE bool isAll(const LaneMask<T, N>& mask) {
  auto all = mask.part[0];
  for (std::size_t p = 1; p < Lanes<T, N>::kParts; ++p) all = hn::And(all, mask.part[p]);
  return hn::AllTrue(typename Lanes<T, N>::Tag(), all);
}

/// Rounded to floats. Beyond their range the result is FLT_MAX or infinity, depending on
/// the machine.
template <std::size_t N>
HWY_INLINE Lanes<float, N> narrowed(const Lanes<double, N>& a) {
  const typename Lanes<float, N>::Tag tag;
  Lanes<float, N> out;
  for (std::size_t p = 0; p < Lanes<float, N>::kParts; ++p) {
    // As many parts of floats as of doubles, or half as many.
    if constexpr (Lanes<float, N>::kParts == Lanes<double, N>::kParts) {
      out.part[p] = hn::DemoteTo(tag, a.part[p]);
    } else {
      const hn::Half<decltype(tag)> half;
      out.part[p] = hn::Combine(tag, hn::DemoteTo(half, a.part[2 * p + 1]),
                                hn::DemoteTo(half, a.part[2 * p]));
    }
  }
  return out;
}

/// Eight pairs of numbers: the first ones and the second ones.
HWY_INLINE void loadTwoEach(const float* from, Lanes<double, kEight>& first,
                            Lanes<double, kEight>& second) {
  using Parts = Lanes<double, kEight>;
  const Parts::Tag tag;
  const hn::Rebind<float, Parts::Tag> floats;
  for (std::size_t p = 0; p < Parts::kParts; ++p) {
    hn::Vec<decltype(floats)> even, odd;
    hn::LoadInterleaved2(floats, from + 2 * p * Parts::kWidth, even, odd);
    first.part[p] = hn::PromoteTo(tag, even);
    second.part[p] = hn::PromoteTo(tag, odd);
  }
}

#if HWY_TARGET == HWY_AVX2
/// For each set of eight lanes, their numbers in ascending order, four bits each.
struct LaneOrders {
  std::uint32_t of[256];

  constexpr LaneOrders() : of{} {
    for (unsigned set = 0; set < 256; ++set)
      for (unsigned lane = 0, next = 0; lane < 8; ++lane)
        if (set >> lane & 1U) of[set] |= lane << (4 * next++);
  }
};

/// The lanes whose bit is set, in their order; any numbers behind them. Highway's
/// Compress() copies a table of 1 KB to the stack in each call (1.0.3, GCC 12).
template <typename Tag>
HWY_INLINE hn::Vec<Tag> compressed(Tag tag, const hn::Vec<Tag>& v, unsigned mask) {
  static_assert(hn::MaxLanes(Tag()) == 8);
  static constexpr LaneOrders kOrders;
  const auto order =
      hn::Shr(hn::Set(tag, kOrders.of[mask & 255]), hn::ShiftLeft<2>(hn::Iota(tag, 0)));
  return hn::TableLookupLanes(v,
                              hn::IndicesFromVec(tag, hn::And(order, hn::Set(tag, 7))));
}
#else
/// The lanes whose bit is set, in their order; any numbers behind them.
template <typename Tag>
HWY_INLINE hn::Vec<Tag> compressed(Tag tag, const hn::Vec<Tag>& v, unsigned mask) {
  // Eight may be read.
  const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(mask),
                                 static_cast<std::uint8_t>(mask >> 8)};
  return hn::Compress(v, hn::LoadMaskBits(tag, bytes));
}
#endif

/// Copies those of 16 numbers whose bit is set, in their order. Up to 16 are written.
/// @param numbers  numbers(tag, i): as many as the tag has lanes, from number i on
template <typename Numbers>
HWY_INLINE void storeWhereSet(unsigned mask, const Numbers& numbers, std::uint32_t* to) {
  const hn::CappedTag<std::uint32_t, kSixteen> tag;
  constexpr std::size_t kWidth = hn::MaxLanes(decltype(tag)());
  for (std::size_t i = 0; i < kSixteen; i += kWidth) {
    hn::StoreU(compressed(tag, numbers(tag, i), mask >> i), tag, to);
    to += countBits(mask >> i & ((1U << kWidth) - 1));
  }
}

/// Copies those of the 16 numbers at `from` whose bit is set. Up to 16 are written, to
/// the same place or before it.
HWY_INLINE void storeSelected(unsigned mask, const std::uint32_t* from,
                              std::uint32_t* to) {
  assert(to <= from && mask >> kSixteen == 0);
  const auto numbers = [from](auto tag, std::size_t i)
                           HWY_ATTR { return hn::LoadU(tag, from + i); };
  storeWhereSet(mask, numbers, to);
}

/// Writes first + i for the set bits i of a mask of 16, in ascending order. Up to 16 more
/// numbers may be written.
HWY_INLINE void storeCounted(unsigned mask, std::uint32_t first, std::uint32_t* to) {
  assert(mask >> kSixteen == 0);
  static constexpr std::uint32_t kNumbers[kSixteen] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                       8, 9, 10, 11, 12, 13, 14, 15};
  const auto numbers = [first](auto tag, std::size_t i) HWY_ATTR {
    return hn::Add(hn::Set(tag, first), hn::LoadU(tag, kNumbers + i));
  };
  storeWhereSet(mask, numbers, to);
}

/// The largest lane; none is a NaN.
template <typename T, std::size_t N>
HWY_INLINE T largest(const Lanes<T, N>& a) {
  auto most = a.part[0];
  for (std::size_t p = 1; p < Lanes<T, N>::kParts; ++p) most = hn::Max(most, a.part[p]);
  typename Lanes<T, N>::Tag tag;
  return hn::GetLane(hn::MaxOfLanes(tag, most));
}

/// Row i, which has four numbers. A vector of eight also has row i + 4, behind row i.
template <typename Tag, typename Row>
HWY_INLINE hn::Vec<Tag> loadRows(Tag tag, const Row& row, std::size_t i) {
  if constexpr (hn::MaxLanes(Tag()) == 4) {
    return hn::LoadU(tag, row(i));
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(tag, loadRows(half, row, i + 4), loadRows(half, row, i));
  }
}

/// The columns of N rows of four.
/// @param row  row(i) points to row i
template <typename Row, typename T, std::size_t N>
HWY_INLINE void loadColumns(const Row& row, Lanes<T, N>& x, Lanes<T, N>& y,
                            Lanes<T, N>& z, Lanes<T, N>& w) {
  const typename Lanes<T, N>::Tag tag;
  FCL_CCD_FOR_PARTS {
    const std::size_t i = p * Lanes<T, N>::kWidth;
    if constexpr (Lanes<T, N>::kWidth == 2) {
      const auto a = hn::LoadU(tag, row(i)), b = hn::LoadU(tag, row(i + 1));
      x.part[p] = hn::InterleaveLower(tag, a, b);
      y.part[p] = hn::InterleaveUpper(tag, a, b);
      const auto c = hn::LoadU(tag, row(i) + 2), d = hn::LoadU(tag, row(i + 1) + 2);
      z.part[p] = hn::InterleaveLower(tag, c, d);
      w.part[p] = hn::InterleaveUpper(tag, c, d);
    } else {
      // In blocks of two lanes: x z of rows 0 and 1, of 2 and 3; then y w.
      const auto r0 = loadRows(tag, row, i), r1 = loadRows(tag, row, i + 1),
                 r2 = loadRows(tag, row, i + 2), r3 = loadRows(tag, row, i + 3);
      const auto xz01 = hn::InterleaveLower(tag, r0, r1),
                 xz23 = hn::InterleaveLower(tag, r2, r3),
                 yw01 = hn::InterleaveUpper(tag, r0, r1),
                 yw23 = hn::InterleaveUpper(tag, r2, r3);
      x.part[p] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(xz23), xz01);
      y.part[p] = hn::OddEvenBlocks(hn::SwapAdjacentBlocks(yw23), yw01);
      z.part[p] = hn::OddEvenBlocks(xz23, hn::SwapAdjacentBlocks(xz01));
      w.part[p] = hn::OddEvenBlocks(yw23, hn::SwapAdjacentBlocks(yw01));
    }
  }
}

/// The first three columns.
template <typename Row, typename T, std::size_t N>
HWY_INLINE void loadColumns(const Row& row, Lanes<T, N>& x, Lanes<T, N>& y,
                            Lanes<T, N>& z) {
  Lanes<T, N> w;
  loadColumns(row, x, y, z, w);
}

/// Eight rows of eight become columns.
HWY_INLINE void transpose(Lanes<float, kEight> (&x)[kEight]) {
  using Parts = Lanes<float, kEight>;
  const Parts::Tag tag;
  const hn::Repartition<std::uint64_t, Parts::Tag> twos;
  // Four by four, in blocks of four lanes: column 4 b + i of rows g to g + 3 is block b
  // of x[g + i] then.
  for (std::size_t g = 0; g < kEight; g += 4)
    for (std::size_t p = 0; p < Parts::kParts; ++p) {
      auto& x0 = x[g].part[p];
      auto& x1 = x[g + 1].part[p];
      auto& x2 = x[g + 2].part[p];
      auto& x3 = x[g + 3].part[p];
      const auto a = hn::BitCast(twos, hn::InterleaveLower(tag, x0, x1)),
                 b = hn::BitCast(twos, hn::InterleaveUpper(tag, x0, x1)),
                 c = hn::BitCast(twos, hn::InterleaveLower(tag, x2, x3)),
                 d = hn::BitCast(twos, hn::InterleaveUpper(tag, x2, x3));
      x0 = hn::BitCast(tag, hn::InterleaveLower(twos, a, c));
      x1 = hn::BitCast(tag, hn::InterleaveUpper(twos, a, c));
      x2 = hn::BitCast(tag, hn::InterleaveLower(twos, b, d));
      x3 = hn::BitCast(tag, hn::InterleaveUpper(twos, b, d));
    }
  for (std::size_t i = 0; i < 4; ++i) {
    const Parts low = x[i], high = x[i + 4];
    if constexpr (Parts::kParts == 1) {
      x[i].part[0] = hn::ConcatLowerLower(tag, high.part[0], low.part[0]);
      x[i + 4].part[0] = hn::ConcatUpperUpper(tag, high.part[0], low.part[0]);
    } else {
      x[i].part[1] = high.part[0];
      x[i + 4].part[0] = low.part[1];
    }
  }
}

#undef FCL_CCD_FOR_PARTS

}  // namespace HWY_NAMESPACE
}  // namespace deformable
}  // namespace detail
}  // namespace fcl
HWY_AFTER_NAMESPACE();
