// SPDX-License-Identifier: BSD-3-Clause
//
// Models from generated meshes, and comparison of the answers of two queries.
#ifndef FCL_TEST_SUPPORT_TEST_MODELS_H
#define FCL_TEST_SUPPORT_TEST_MODELS_H

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

// FCL's templates that are in the library are not compiled again.
#include "fcl/common/exception.h"
#include "fcl/geometry/bvh/BVH_model.h"
#include "fcl/narrowphase/continuous_collision.h"
#include "fcl_in_float.h"
#include "mesh_generators.h"
#include "model/model_instances.h"

namespace fcl {
namespace test {

template <typename S>
std::vector<Vector3<S>> pointsAs(const std::vector<Vector3<double>>& points) {
  std::vector<Vector3<S>> out;
  out.reserve(points.size());
  for (const Vector3<double>& p : points) out.push_back(p.template cast<S>());
  return out;
}

/// @brief The mesh with coordinates that float holds exactly.
inline TestMesh floatMesh(TestMesh mesh) {
  // volatile: gcc 12 drops the two conversions that Eigen makes of p.cast<float>()
  // .cast<double>() at -O3.
  for (auto& p : mesh.vertices)
    for (int k = 0; k < 3; ++k) {
      const volatile float rounded = static_cast<float>(p[k]);
      p[k] = rounded;
    }
  return mesh;
}

/// @brief `mesh` with every coordinate moved by a random amount in [-half, half].
inline TestMesh shaken(TestMesh mesh, double half, std::uint64_t seed) {
  Random random(seed);
  for (auto& p : mesh.vertices) p += random.point(half);
  return floatMesh(std::move(mesh));
}

/// @brief A bent sheet of n x n quads over the unit square, free of self-contact.
inline TestMesh bentSheet(int n, double z = 0) {
  return floatMesh(makeSheet(n, n, [z](double u, double v) {
    return Vector3<double>(u, v, z + 0.2 * u * u + 0.1 * u * v);
  }));
}

/// @brief The mesh moved by (x, y, z).
inline TestMesh moved(TestMesh mesh, double x, double y, double z) {
  for (auto& p : mesh.vertices) p += Vector3<double>(x, y, z);
  return mesh;
}

template <typename Model>
std::shared_ptr<Model> makeModel(const TestMesh& mesh) {
  using S = typename std::decay_t<decltype(*Model::vertices)>::Scalar;
  auto model = std::make_shared<Model>();
  EXPECT_EQ(model->beginModel(static_cast<int>(mesh.triangles.size()),
                              static_cast<int>(mesh.vertices.size())),
            BVH_OK);
  EXPECT_EQ(model->addSubModel(pointsAs<S>(mesh.vertices), mesh.triangles), BVH_OK);
  EXPECT_EQ(model->endModel(), BVH_OK);
  return model;
}

/// @brief Gives the next frame to a model. Its functions are not virtual: pass it by its
/// own type, not as a base class.
template <typename Model>
int update(Model& model, const TestMesh& frame) {
  using S = typename std::decay_t<decltype(*Model::vertices)>::Scalar;
  if (const int code = model.beginUpdateModel()) return code;
  if (const int code = model.updateSubModel(pointsAs<S>(frame.vertices))) return code;
  return model.endUpdateModel();
}

template <typename Model>
std::shared_ptr<Model> makeModel(const TestMesh& previous, const TestMesh& current) {
  auto model = makeModel<Model>(previous);
  EXPECT_EQ(update(*model, current), BVH_OK);
  return model;
}

template <typename S>
ContinuousContactResult<S> selfContacts(
    const CollisionGeometry<S>& o,
    const ContinuousContactRequest<S>& request = ContinuousContactRequest<S>()) {
  ContinuousContactResult<S> result;
  EXPECT_EQ(continuousSelfCollide(&o, request, result), result.time_of_contact);
  return result;
}

template <typename S>
ContinuousContactResult<S> pairContacts(
    const CollisionGeometry<S>& o1, const Transform3<S>& tf1,
    const CollisionGeometry<S>& o2, const Transform3<S>& tf2,
    const ContinuousContactRequest<S>& request = ContinuousContactRequest<S>()) {
  ContinuousContactResult<S> result;
  EXPECT_EQ(continuousCollide(&o1, tf1, tf1, &o2, tf2, tf2, request, result),
            result.time_of_contact);
  return result;
}

template <typename S>
ContinuousContactResult<S> pairContacts(
    const CollisionGeometry<S>& o1, const CollisionGeometry<S>& o2,
    const ContinuousContactRequest<S>& request = ContinuousContactRequest<S>()) {
  const Transform3<S> identity = Transform3<S>::Identity();
  return pairContacts(o1, identity, o2, identity, request);
}

/// @brief Identifies a contact, independent of the method that found it.
using ContactName = std::tuple<int, bool, std::array<int, 5>>;

template <typename S>
ContactName nameOf(const ContinuousContact<S>& c) {
  return {static_cast<int>(c.kind), c.first_on_o1, c.vertices};
}

template <typename S>
std::vector<ContactName> namesOf(const std::vector<ContinuousContact<S>>& contacts) {
  std::vector<ContactName> names;
  for (const auto& c : contacts) names.push_back(nameOf(c));
  std::sort(names.begin(), names.end());
  return names;
}

/// @brief Expects equal bits, except for the geometries' addresses and the times of the
/// stages.
template <typename S, typename T>
void expectIdentical(const ContinuousContactResult<S>& x,
                     const ContinuousContactResult<T>& y, bool with_geometry = true) {
  EXPECT_EQ(x.is_collide, y.is_collide);
  if (with_geometry) {
    EXPECT_EQ(x.time_of_contact, y.time_of_contact);
  }
  EXPECT_EQ(x.contacts_cut, y.contacts_cut);
  EXPECT_EQ(x.initially_crossing, y.initially_crossing);
  ASSERT_EQ(x.contacts.size(), y.contacts.size());
  for (std::size_t i = 0; i < x.contacts.size(); ++i) {
    const auto& a = x.contacts[i];
    const auto& b = y.contacts[i];
    ASSERT_EQ(nameOf(a), nameOf(b)) << "contact " << i;
    ASSERT_EQ(a.toc_lo, b.toc_lo) << "contact " << i;
    ASSERT_EQ(a.toc_hi, b.toc_hi) << "contact " << i;
    if (!with_geometry) continue;
    ASSERT_EQ(a.b1, b.b1) << "contact " << i;
    ASSERT_EQ(a.b2, b.b2) << "contact " << i;
    ASSERT_TRUE(a.pos.template cast<double>() == b.pos.template cast<double>());
    ASSERT_TRUE(a.normal.template cast<double>() == b.normal.template cast<double>());
  }
}

/// @brief Expects the same contacts, with brackets that overlap.
template <typename S, typename T>
void expectSameContacts(const ContinuousContactResult<S>& x,
                        const ContinuousContactResult<T>& y) {
  EXPECT_EQ(x.is_collide, y.is_collide);
  EXPECT_EQ(x.initially_crossing, y.initially_crossing);
  const auto sorted = [](auto contacts) {
    std::sort(contacts.begin(), contacts.end(),
              [](const auto& a, const auto& b) { return nameOf(a) < nameOf(b); });
    return contacts;
  };
  const auto a = sorted(x.contacts);
  const auto b = sorted(y.contacts);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(nameOf(a[i]), nameOf(b[i]));
    ASSERT_LE(a[i].toc_lo, b[i].toc_hi);
    ASSERT_LE(b[i].toc_lo, a[i].toc_hi);
  }
}

inline void expectMessage(const std::string& message, const std::string& word) {
  if (message.empty())
    ADD_FAILURE() << "nothing thrown; expected a message with '" << word << "'";
  EXPECT_NE(message.find(word), std::string::npos) << message;
}

/// @brief The message of the fcl::Exception that a call throws; empty if it throws none.
template <typename Call>
std::string errorOf(Call&& call) {
  try {
    call();
  } catch (const Exception& error) {
    return error.what();
  }
  return "";
}

/// @brief Expects fcl::Exception with a message that contains `word`.
template <typename Call>
void expectRefused(Call&& call, const std::string& word) {
  expectMessage(errorOf(call), word);
}

}  // namespace test
}  // namespace fcl

#endif
