#include "formats/rosbag/ros_encode.h"

#include "formats/rosbag/ros_header.h"

namespace rayfield::formats {
namespace {

void put_vector3(const Eigen::Vector3d& vector, ByteBuilder& out) {
  for (int i = 0; i < 3; ++i) out.put(vector(i));
}

void put_zeros(int count, ByteBuilder& out) {
  for (int i = 0; i < count; ++i) out.put(0.0);
}

}  // namespace

void encode_imu(const ImuSample& sample, std::uint32_t seq, std::string_view frame, ByteBuilder& out) {
  put_ros_header(seq, sample.time_s, frame, out);
  put_zeros(3, out), out.put(1.0);
  out.put(-1.0), put_zeros(8, out);  // orientation not measured
  put_vector3(sample.angular_velocity_rad_s, out);
  put_zeros(9, out);  // covariances of zero mean unknown
  put_vector3(sample.linear_acceleration_m_s2, out);
  put_zeros(9, out);
}

void encode_nav_sat_fix(const GpsFix& fix, std::uint32_t seq, std::string_view frame, ByteBuilder& out) {
  constexpr std::uint16_t kServiceGps = 1;
  put_ros_header(seq, fix.time_s, frame, out);
  out.put(static_cast<std::int8_t>(fix.status));
  out.put(kServiceGps);
  out.put(fix.latitude_deg), out.put(fix.longitude_deg), out.put(fix.height_m);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.put(fix.covariance_enu_m2(row, column));
  }
  out.put(static_cast<std::uint8_t>(fix.covariance_type));
}

void encode_joint_state(const SpinnerAngle& angle, double rate_rad_s, std::uint32_t seq, std::string_view frame,
                        std::string_view joint, ByteBuilder& out) {
  put_ros_header(seq, angle.time_s, frame, out);
  out.put(std::uint32_t{1}), out.text(joint);
  out.put(std::uint32_t{1}), out.put(angle.angle_rad);
  out.put(std::uint32_t{1}), out.put(rate_rad_s);
  out.put(std::uint32_t{0});
}

}  // namespace rayfield::formats
