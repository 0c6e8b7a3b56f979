// The Slotine-Li step with Pinocchio: tau = Y(q, dq, z, dz) theta and g = Y(q, dq, z, dz)^T s.
//
// Pinocchio has no two-velocity regressor; both ways use the identity
//   Y(q, dq, z, dz) = Y_std(q, (dq + z)/2, dz) - Y_std without gravity(q, (dq - z)/2, 0).
//
//   A  two standard joint torque regressors and matrix-vector products: what a user would write;
//   B  two rnea for tau, and for g the two body regressors of every body against the body velocity that s gives.
//
// B sets the bodies' inertias from theta first, which divides by the mass: it breaks at theta = 0.
//
// Reads arms from standard input, as slotine_li.py writes them; prints one JSON line per case: thread CPU time per step
// in ns, median, least and largest over the batches. The last field is the largest difference between A and B.

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include <pinocchio/multibody.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr int kStates = 64, kBatches = 200, kCalls = 400;

static double cpu_ns() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * 1e9 + now.tv_nsec;
}

struct State {
  Vector q, dq, z, dz, s;
};

struct Arm {
  pinocchio::Model model, weightless;
  pinocchio::Data data, weightless_data, test;
  Vector theta, tau, gradient, half_sum, half_difference, zero;
  Matrix regressor;

  explicit Arm(const pinocchio::Model& m)
      : model(m), weightless(m), data(m), weightless_data(m), test(m), theta(10 * m.nv), tau(m.nv),
        gradient(10 * m.nv), half_sum(m.nv), half_difference(m.nv), zero(Vector::Zero(m.nv)),
        regressor(m.nv, 10 * m.nv) {
    weightless.gravity.setZero();
    for (int i = 1; i < model.njoints; ++i) theta.segment<10>(10 * (i - 1)) = model.inertias[i].toDynamicParameters();
  }

  void a(const State& x) {
    half_sum.noalias() = 0.5 * (x.dq + x.z);
    half_difference.noalias() = 0.5 * (x.dq - x.z);
    pinocchio::computeJointTorqueRegressor(model, data, x.q, half_sum, x.dz);
    pinocchio::computeJointTorqueRegressor(weightless, weightless_data, x.q, half_difference, zero);
    regressor.noalias() = data.jointTorqueRegressor - weightless_data.jointTorqueRegressor;
    tau.noalias() = regressor * theta;
    gradient.noalias() = regressor.transpose() * x.s;
  }

  void b(const State& x) {
    for (int i = 1; i < model.njoints; ++i) {
      model.inertias[i] = pinocchio::Inertia::FromDynamicParameters(theta.segment<10>(10 * (i - 1)));
      weightless.inertias[i] = model.inertias[i];
    }
    half_sum.noalias() = 0.5 * (x.dq + x.z);
    half_difference.noalias() = 0.5 * (x.dq - x.z);
    tau = pinocchio::rnea(model, data, x.q, half_sum, x.dz);
    tau -= pinocchio::rnea(weightless, weightless_data, x.q, half_difference, zero);
    pinocchio::forwardKinematics(model, test, x.q, x.s);
    for (int i = 1; i < model.njoints; ++i) {
      const auto plus = pinocchio::bodyRegressor(data.v[i], data.a_gf[i]);
      const auto minus = pinocchio::bodyRegressor(weightless_data.v[i], weightless_data.a_gf[i]);
      gradient.segment<10>(10 * (i - 1)).noalias() = (plus - minus).transpose() * test.v[i].toVector();
    }
  }
};

template <typename Call>
static void measure(const std::string& arm, const char* which, const std::vector<State>& states, double mismatch,
                    Call call) {
  std::vector<double> times;
  size_t next = 0;
  for (int batch = 0; batch < kBatches; ++batch) {
    const double start = cpu_ns();
    for (int k = 0; k < kCalls; ++k) call(states[next++ % states.size()]);
    times.push_back((cpu_ns() - start) / kCalls);
  }
  std::sort(times.begin(), times.end());
  std::printf("{\"arm\":\"%s\",\"case\":\"%s\",\"median_ns\":%.1f,\"min_ns\":%.1f,\"max_ns\":%.1f,\"mismatch\":%.1e}\n",
              arm.c_str(), which, times[kBatches / 2], times.front(), times.back(), mismatch);
}

static pinocchio::Model read_model(int joints) {
  pinocchio::Model model;
  for (int i = 0; i < joints; ++i) {
    int parent;
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation;
    Eigen::Vector3d translation, axis;
    Eigen::Matrix<double, 10, 1> inertia;
    std::cin >> parent;
    for (int k = 0; k < 9; ++k) std::cin >> rotation.data()[k];
    for (int k = 0; k < 3; ++k) std::cin >> translation[k];
    for (int k = 0; k < 3; ++k) std::cin >> axis[k];
    for (int k = 0; k < 10; ++k) std::cin >> inertia[k];
    const pinocchio::SE3 placement(rotation, translation);
    const std::string name = "joint_" + std::to_string(i);
    pinocchio::JointIndex id;
    if (axis == Eigen::Vector3d::UnitX()) id = model.addJoint(parent, pinocchio::JointModelRX(), placement, name);
    else if (axis == Eigen::Vector3d::UnitY()) id = model.addJoint(parent, pinocchio::JointModelRY(), placement, name);
    else if (axis == Eigen::Vector3d::UnitZ()) id = model.addJoint(parent, pinocchio::JointModelRZ(), placement, name);
    else id = model.addJoint(parent, pinocchio::JointModelRevoluteUnaligned(axis), placement, name);
    model.appendBodyToJoint(id, pinocchio::Inertia::FromDynamicParameters(inertia), pinocchio::SE3::Identity());
  }
  return model;
}

int main() {
  std::string name;
  int joints;
  while (std::cin >> name >> joints) {
    Arm arm(read_model(joints));
    std::srand(1);
    std::vector<State> states;
    for (int k = 0; k < kStates; ++k)
      states.push_back({Vector::Random(joints), Vector::Random(joints), Vector::Random(joints), Vector::Random(joints),
                        Vector::Random(joints)});
    double mismatch = 0;
    for (const State& x : states) {
      arm.a(x);
      const Vector tau = arm.tau, gradient = arm.gradient;
      arm.b(x);
      mismatch = std::max({mismatch, (tau - arm.tau).cwiseAbs().maxCoeff(),
                           (gradient - arm.gradient).cwiseAbs().maxCoeff()});
    }
    measure(name, "pinocchio A", states, mismatch, [&](const State& x) { arm.a(x); });
    measure(name, "pinocchio B", states, mismatch, [&](const State& x) { arm.b(x); });
    pinocchio::Data forward(arm.model);
    measure(name, "pinocchio forward dynamics", states, mismatch,
            [&](const State& x) { pinocchio::aba(arm.model, forward, x.q, x.dq, x.z); });
  }
}
