// SPDX-License-Identifier: BSD-3-Clause
//
// Continuous collision of many objects: which of them meet during the step, and when, and
// how near they come.
#ifndef FCL_BROADPHASE_CONTINUOUS_COLLISION_MANAGER_H
#define FCL_BROADPHASE_CONTINUOUS_COLLISION_MANAGER_H

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "fcl/broadphase/broadphase_continuous_collision_manager.h"
#include "fcl/broadphase/detail/manager_result.h"
#include "fcl/broadphase/detail/nearest_objects.h"
#include "fcl/broadphase/detail/object_distances.h"
#include "fcl/broadphase/detail/object_motions.h"
#include "fcl/broadphase/detail/pair_answers.h"
#include "fcl/broadphase/detail/persistent_pairs.h"
#include "fcl/broadphase/swept_collision_object.h"
#include "fcl/narrowphase/continuous_collision.h"

namespace fcl {

template <typename S>
class CollisionRobot;

/// @brief Finds the contacts of many objects that move. FCL declares the interface
/// BroadPhaseContinuousCollisionManager and has no class that implements it; this class
/// does.
///
/// Objects are meshes, shapes and octrees that follow any motion. Each has a box that
/// moves: boxes at the ends of up to 16 spans of the step, enlarged by the distance that
/// the motion can deviate from straight lines in between. Two objects are a box pair if
/// their boxes overlap at the same time. So objects that fly side by side are no box
/// pair, and no contact is missed. FCL's ContinuousCollisionObject::computeAABB() is not
/// used.
///
/// An object has no box (SweptCollisionObject: an infinite one), and is a box pair with
/// all others, if its motion is a class of the program that is no BoundedMotion, or if it
/// is a point cloud. A tilted plane or halfspace has none either, but bounds itself.
///
/// The manager reads an object when it is registered or updated. After a change of its
/// motion or of its geometry call update(): queries throw after a change of a
/// DeformableBVHModel by itself; other changes they cannot see. An object that rests (its
/// box is the same at all times) costs nothing in a step in which it is not updated.
///
/// Queries name pairs by their objects, in the order of their registration. The order of
/// box pairs is that of the beginnings of their windows.
///
/// Time: to register, update or unregister one object O(log n); to update() all, or a
/// large part of them at once, O(n log n), to build a new tree.
///
/// Thread-safety: const functions may run at the same time, except those that call back
/// with FCL's CollisionCallBack or DistanceCallBack. The broad phase itself runs in the
/// caller's thread. ContinuousContactRequest::num_threads is for the pairs, which several
/// threads test at the same time, and for the query of each of them; with
/// accepts_triangles pairs come one after the other. Answers do not depend on it.
///
/// The manager does not own the objects. They must live until they are unregistered.
///
/// A ContinuousCollisionCallBack may change the manager. The pairs of its query were
/// found before, and all of them come: objects that it unregisters must live until the
/// query returns. FCL's CollisionCallBack must not unregister objects, and its
/// DistanceCallBack must not change the manager.
///
/// @throws fcl::Exception  An object is null, or has no geometry or motion; it is
/// registered twice, or is not registered; a mesh is not built; a geometry or a path is
/// not finite. Then nothing has changed.
template <typename S>
class ContinuousCollisionManager : public BroadPhaseContinuousCollisionManager<S> {
 public:
  using Object = ContinuousCollisionObject<S>;

  ContinuousCollisionManager() = default;
  ContinuousCollisionManager(const ContinuousCollisionManager&) = delete;
  ContinuousCollisionManager& operator=(const ContinuousCollisionManager&) = delete;

  /// @brief Adds objects.
  void registerObjects(const std::vector<Object*>& objects) override;
  /// @brief Adds an object.
  void registerObject(Object* object) override;
  /// @brief Removes an object.
  void unregisterObject(Object* object) override;
  /// @brief Removes all objects.
  void clear() override;

  /// @brief Makes new trees, as FCL's managers do. Queries do not need it: it may make
  /// them faster after many single changes.
  void setup() override;
  /// @brief Reads all objects again.
  void update() override;
  /// @brief Reads one object again.
  void update(Object* object) override;
  /// @brief Reads these objects again, for example those that moved.
  void update(const std::vector<Object*>& objects) override;

  /// @brief Gives an object a new motion, and reads the object. The object releases its
  /// old motion.
  void setMotion(Object* object, const std::shared_ptr<MotionBase<S>>& motion);
  /// @brief The same for many objects, one motion each.
  void setMotion(const std::vector<Object*>& objects,
                 const std::vector<std::shared_ptr<MotionBase<S>>>& motions);
  /// @brief The motion from one pose to another: the origin goes straight, the rotation
  /// turns about one axis at a constant rate (FCL's InterpMotion). If rotations are equal
  /// it is a TranslationMotion, as a mesh that deforms needs it. In float, where FCL has
  /// no motion that turns, a TwistMotion about the origin.
  void setMotion(Object* object, const Transform3<S>& tf_beg,
                 const Transform3<S>& tf_end);
  /// @brief The next step of an object: the motion from where its motion ends to a pose.
  void step(Object* object, const Transform3<S>& tf_end);
  /// @brief The same for many objects, one pose each. Of an object that comes twice the
  /// last pose counts.
  void step(const std::vector<Object*>& objects,
            const std::vector<Transform3<S>>& tf_end);

  /// @brief Sets the thickness of an object, in the unit of the coordinates: two objects
  /// are in contact when they come within the sum of both thicknesses, in addition to the
  /// request's min_distance; an object with itself within twice its own. Of an object
  /// that is not registered it is 0.
  ///
  /// It acts in the queries for contacts that take a request, and in the pairs of all
  /// callbacks for contacts. distance() is that of the geometries.
  void setThickness(Object* object, S thickness);
  /// @brief Sets the distance of two objects of this manager, in place of the sum of
  /// their thicknesses. Not between objects of two managers. The boxes of both grow by
  /// half of it or more, so a large one makes more pairs of them with others too.
  void setPairDistance(Object* o1, Object* o2, S distance);
  /// @brief Takes back setPairDistance().
  void resetPairDistance(Object* o1, Object* o2);

  /// @brief Sets how fast others must approach this object to be in contact with it: the
  /// request's min_approach_speed for the pairs of the object, if that is less. Of two
  /// objects the larger speed counts. It acts on pairs of meshes on straight paths; of
  /// other pairs all contacts count. Of an object that is not registered it is 0.
  void setMinApproachSpeed(Object* object, S speed);

  /// @brief Sets with which objects this one can be in contact. Callbacks do not get a
  /// pair that the filters reject. Groups of triangles act in the queries that take a
  /// request.
  void setFilter(Object* object, const ContinuousFilter& filter);
  /// @brief Sets whether queries of all objects that take a request look for contacts of
  /// the object with itself, whatever its group and mask are; groups and masks of its
  /// triangles act. It must be a mesh.
  void setSelfCollision(Object* object, bool enabled);

  /// @brief The objects, in the order of their registration.
  void getObjects(std::vector<Object*>& objects) const override;
  /// @brief Whether there is no object.
  bool empty() const override { return size() == 0; }
  /// @brief The number of objects.
  std::size_t size() const override { return boxes_.size(); }

  /// @brief First contact, any contact, or all contacts of all objects: request.query.
  ///
  /// kFirst: pairs are tested in the order of their windows, up to the best time so far,
  /// or until two touch at t = 0.
  /// All fields of the request act as in continuousCollide() of a pair, with these
  /// differences: filter1 and filter2 are those of setFilter(); num_max_contacts is per
  /// pair. With the request's min_distance above 0 pairs of two objects that rest are
  /// searched anew in each query; a thickness does not do that.
  /// @throws fcl::Exception  what continuousCollide() throws, with the numbers of the
  /// objects in getObjects()
  void collide(const ContinuousContactRequest<S>& request,
               ContinuousManagerResult<S>& result) const;
  /// @brief The same for one object, which is o1, with all others. It need not be
  /// registered. It is read now.
  void collide(Object* object, const ContinuousContactRequest<S>& request,
               ContinuousManagerResult<S>& result) const;
  /// @brief The same for the objects of this manager, which are o1, and of another one.
  void collide(const ContinuousCollisionManager& other,
               const ContinuousContactRequest<S>& request,
               ContinuousManagerResult<S>& result) const;

  /// @brief Gives the pairs in contact to `visit` instead of a list, so that contacts
  /// need no memory: with ContinuousQuery::kAll each pair comes once it is tested, in the
  /// order of the box pairs, until visit returns true; with kFirst and kAny the one pair.
  /// At any time the query keeps the contacts of at most one pair, with several threads
  /// of up to 1,024, and a list of all box pairs, 32 bytes each. num_max_contacts bounds
  /// the contacts of a pair. The calls come from the caller's thread. They must not
  /// change the manager.
  void collide(const ContinuousContactRequest<S>& request,
               const std::function<bool(ContinuousPairResult<S>&)>& visit) const;

  /// @brief Calls back for each box pair of all objects, in the order of their windows,
  /// until the callback returns true. FCL's default callback is
  /// DefaultContinuousCollisionFunction, which keeps the answer for the last pair only.
  void collide(void* cdata, ContinuousCollisionCallBack<S> callback) const;
  /// @brief Calls back for the box pairs of one object, which is the first argument.
  void collide(Object* object, void* cdata,
               ContinuousCollisionCallBack<S> callback) const;
  /// @brief Calls back for the box pairs of this manager and of another one.
  void collide(const ContinuousCollisionManager& other, void* cdata,
               ContinuousCollisionCallBack<S> callback) const;

  /// @brief FCL's interface has the callback of discrete queries. It gets a
  /// SweptCollisionObject for each object. These live until the object is unregistered.
  void collide(void* cdata, CollisionCallBack<S> callback) const override;
  /// @overload
  void collide(Object* object, void* cdata, CollisionCallBack<S> callback) const override;
  /// @overload
  /// @throws fcl::Exception  the other manager is no ContinuousCollisionManager. (In a
  /// program that is compiled with -fno-rtti also: it is of a derived class, and not of
  /// the class of this one.)
  void collide(BroadPhaseContinuousCollisionManager<S>* other, void* cdata,
               CollisionCallBack<S> callback) const override;

  /// @brief The least distance of all objects from each other, and when: of all pairs
  /// that the filters do not reject. As in continuousDistance() it is proved from both
  /// sides, and is 0 if any two objects touch, with the two that touch first.
  ///
  /// Only pairs whose boxes come near enough are looked at. All fields of the request act
  /// as in continuousDistance(), but filter1 and filter2 are those of setFilter(). With
  /// setSelfCollision() nothing changes: a mesh has no distance from itself. Pairs of two
  /// planes or halfspaces are left out, also if they touch.
  /// @throws fcl::Exception  what continuousDistance() throws, with the numbers of the
  /// objects in getObjects()
  void distance(const ContinuousDistanceRequest<S>& request,
                ContinuousManagerDistance<S>& result) const;
  /// @brief The same for one object, which is o1, and all others. It need not be
  /// registered. It is read now.
  void distance(Object* object, const ContinuousDistanceRequest<S>& request,
                ContinuousManagerDistance<S>& result) const;
  /// @brief The same for the objects of this manager, which are o1, and of another one.
  void distance(const ContinuousCollisionManager& other,
                const ContinuousDistanceRequest<S>& request,
                ContinuousManagerDistance<S>& result) const;

  /// @brief FCL's interface: calls back for pairs of objects, those whose boxes come
  /// nearest first, while their boxes may be nearer than `dist`, which the callback
  /// lowers. It gets a SweptCollisionObject for each object, as in collide(). Pairs of
  /// two planes or halfspaces do not come. The callback must not change the manager. See
  /// DefaultContinuousDistanceFunction().
  void distance(void* cdata, DistanceCallBack<S> callback) const override;
  /// @overload
  void distance(Object* object, void* cdata, DistanceCallBack<S> callback) const override;
  /// @overload
  /// @throws fcl::Exception  the other manager is no ContinuousCollisionManager
  void distance(BroadPhaseContinuousCollisionManager<S>* other, void* cdata,
                DistanceCallBack<S> callback) const override;

 private:
  friend class CollisionRobot<S>;

  using Pairs = std::vector<detail::BroadPhasePair>;
  using Request = ContinuousContactRequest<S>;
  using Result = ContinuousManagerResult<S>;
  using PairResult = ContinuousPairResult<S>;
  using SweptObjects =
      std::unordered_map<const Object*, std::unique_ptr<SweptCollisionObject<S>>>;

  static Object* objectOf(void* object) { return static_cast<Object*>(object); }
  static std::vector<void*> addressesOf(const std::vector<Object*>& objects);
  static detail::BroadPhaseSettings settingsOf(const Request& request);
  static detail::BroadPhaseSettings allBoxPairs() { return {0, 1, false}; }

  /// Two sets of objects, of which each one of the first meets each one of the second.
  struct Sides {
    /// Null: the objects of the first set meet each other.
    const ContinuousCollisionManager* other;
    /// The first set, if it is one object. Null: it is all of this manager.
    Object* object;
  };

  const ContinuousFilter& filterOf(const Object* object) const;
  static bool hasTriangles(const ContinuousFilter& filter) {
    return !filter.triangle_groups.empty() || !filter.triangle_masks.empty();
  }
  std::string nameOf(const Object* object) const;
  S distanceOf(const Object* o1, const ContinuousCollisionManager& other,
               const Object* o2) const;
  S approachSpeedOf(const Object* o1, const ContinuousCollisionManager& other,
                    const Object* o2, S of_request) const;
  void requireRegistered(const Object* object) const;
  void setMargin(const void* object);
  bool test(const detail::BroadPhasePair& pair, const ContinuousCollisionManager& other,
            Request& request, PairResult& tested) const;
  class PairTest;
  /// @param as_set  whether thickness, distances and approach speeds of objects act
  void answer(const Pairs& pairs, const ContinuousCollisionManager& other,
              const Request& request, Result& result, bool as_set = true) const;
  static void callBack(const Pairs& pairs, void* cdata,
                       ContinuousCollisionCallBack<S> callback);
  CollisionObject<S>* sweptObject(Object* object) const;
  /// The other manager as one of this class; null if it is none.
  const ContinuousCollisionManager* managerOf(
      const BroadPhaseContinuousCollisionManager<S>* other) const;
  const ContinuousCollisionManager& requireManager(
      const BroadPhaseContinuousCollisionManager<S>* other, const char* query) const;
  /// The box pairs, without those of two planes or halfspaces.
  Pairs pairsOf(const Sides& sides, const detail::BroadPhaseSettings& settings) const;
  /// The pairs in the order of the distance of their boxes, without the same.
  /// @param visit  S visit(o1, o2) returns the distance beyond which pairs do not count
  template <typename Visit>
  void visitNearest(const Sides& sides, S t_max, S limit, const Visit& visit) const;
  void answerDistance(const Sides& sides, const ContinuousDistanceRequest<S>& request,
                      ContinuousManagerDistance<S>& result) const;
  void callBack(const Sides& sides, void* cdata, DistanceCallBack<S> callback) const;
  void callBack(const Pairs& pairs, const ContinuousCollisionManager& other, void* cdata,
                CollisionCallBack<S> callback) const;

  detail::ContinuousBroadPhase<S> boxes_;
  /// The filters that setFilter() has set.
  std::unordered_map<const Object*, ContinuousFilter> filters_;
  detail::ObjectDistances<S> distances_;
  /// Those that setMinApproachSpeed() has set, above 0.
  std::unordered_map<const Object*, S> approach_speeds_;
  mutable SweptObjects swept_objects_;
};

using ContinuousCollisionManagerf = ContinuousCollisionManager<float>;
using ContinuousCollisionManagerd = ContinuousCollisionManager<double>;

}  // namespace fcl

// The functions, by what they do.
#include "fcl/broadphase/detail/manager_contacts.h"
#include "fcl/broadphase/detail/manager_distances.h"
#include "fcl/broadphase/detail/manager_objects.h"

#endif
