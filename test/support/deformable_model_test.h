// SPDX-License-Identifier: BSD-3-Clause
//
// Shared by the tests of DeformableBVHModel: the models, on every BV type and both
// scalars, and checks of their state.
#ifndef FCL_TEST_DEFORMABLE_MODEL_TEST_H
#define FCL_TEST_DEFORMABLE_MODEL_TEST_H

#include <string>
#include <vector>

#include "fcl/geometry/bvh/deformable_bvh_model.h"
#include "fcl/math/bv/OBBRSS.h"
#include "fcl/math/bv/kIOS.h"
#include "fcl/math/bv/utility.h"
#include "test_models.h"

namespace fcl {
namespace test {

inline const TestMesh kSheet = bentSheet(8);
/// The n-th frame of the sheet, which is crumpled enough for self-contacts.
inline TestMesh frame(std::uint64_t n) { return shaken(kSheet, 0.15, 100 + n); }

template <typename BV>
class DeformableModel : public ::testing::Test {
 protected:
  using S = typename BV::S;
  using Model = DeformableBVHModel<BV>;
  using Plain = BVHModel<BV>;
  using Points = std::vector<Vector3<S>>;

  static Points points(const TestMesh& mesh) { return pointsAs<S>(mesh.vertices); }

  static Points previousOf(const Plain& model) {
    return Points(model.prev_vertices, model.prev_vertices + model.num_vertices);
  }
  static Points currentOf(const Plain& model) {
    return Points(model.vertices, model.vertices + model.num_vertices);
  }

  static int updateFrames(Model& model, const Points& previous, const Points& current,
                          FclTree tree = FclTree::kSkip) {
    return model.updateFrames(previous[0].data(), current[0].data(), current.size(),
                              tree);
  }

  /// Expects that the frames are these, that the boxes contain both, and that a query
  /// answers as a plain model with the same frames.
  static void expectFrames(const Model& model, const TestMesh& previous,
                           const TestMesh& current) {
    EXPECT_TRUE(previousOf(model) == points(previous));
    EXPECT_TRUE(currentOf(model) == points(current));
    EXPECT_TRUE(model.lastError().empty()) << model.lastError();
    for (const TestMesh* mesh : {&previous, &current})
      for (const Vector3<S>& p : points(*mesh)) {
        EXPECT_TRUE(model.aabb_local.contain(p));
        EXPECT_LE((p - model.aabb_center).norm(), model.aabb_radius * (1 + S(1e-6)));
      }
    const auto plain = makeModel<Plain>(previous, current);
    const auto expected = selfContacts<S>(*plain);
    expectSameContacts(selfContacts<S>(model), expected);
    if (previousOf(model) != currentOf(model)) {
      EXPECT_GT(expected.contacts.size(), 5u);
    }
  }

  /// Expects that a refused call changes nothing, prints nothing, and names the reason.
  template <typename Call>
  static void expectRefusal(Model& model, int code, const std::string& word,
                            Call&& call) {
    const Untouched before(model);
    const int got = call();
    before.expectSame(model, got, code, word);
  }

 private:
  /// What a refused call leaves as it is. Apart from the call, which is another type each
  /// time, so that it is compiled once.
  struct Untouched {
    Points previous, current;
    BVHBuildState state;
    bool up_to_date;
    ContinuousContactResult<S> contacts;

    explicit Untouched(const Model& model)
        : previous(previousOf(model)),
          current(currentOf(model)),
          state(model.build_state),
          up_to_date(model.isFclTreeUpToDate()),
          contacts(selfContacts<S>(model)) {
      ::testing::internal::CaptureStderr();
    }

    void expectSame(const Model& model, int got, int code,
                    const std::string& word) const {
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
      EXPECT_EQ(got, code) << model.lastError();
      EXPECT_NE(model.lastError().find(word), std::string::npos) << model.lastError();
      EXPECT_TRUE(previousOf(model) == previous);
      EXPECT_TRUE(currentOf(model) == current);
      EXPECT_EQ(model.build_state, state);
      EXPECT_EQ(model.isFclTreeUpToDate(), up_to_date);
      expectIdentical(selfContacts<S>(model), contacts);
    }
  };
};

// Each of FCL's types once, in one of the two scalars. With sanitizers, which take the
// compiler minutes for each, one type for each scalar.
#ifdef NDEBUG
using BVs = ::testing::Types<KDOP<double, 16>, OBBRSS<double>, AABB<double>, kIOS<double>,
                             KDOP<double, 24>, RSS<float>, OBB<float>, KDOP<float, 18>>;
#else
using BVs = ::testing::Types<OBBRSS<double>, KDOP<float, 16>>;
#endif
TYPED_TEST_SUITE(DeformableModel, BVs, );

#define USING_FIXTURE                        \
  using Model = typename TestFixture::Model; \
  using Plain = typename TestFixture::Plain; \
  using S = typename TestFixture::S;         \
  (void)sizeof(Plain);                       \
  (void)sizeof(S)

}  // namespace test
}  // namespace fcl

#endif
