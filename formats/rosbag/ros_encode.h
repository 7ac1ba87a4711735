#pragma once

#include <cstdint>
#include <string_view>

#include "rayfield/core/byte_cursor.h"
#include "rayfield/core/sensor_log.h"

/// The sensor_msgs that rayfield writes, in the serialisation of ros_decode.h.
namespace rayfield::formats {

void encode_imu(const ImuSample& sample, std::uint32_t seq, std::string_view frame, ByteBuilder& out);
void encode_nav_sat_fix(const GpsFix& fix, std::uint32_t seq, std::string_view frame, ByteBuilder& out);
void encode_joint_state(const SpinnerAngle& angle, double rate_rad_s, std::uint32_t seq, std::string_view frame,
                        std::string_view joint, ByteBuilder& out);

}  // namespace rayfield::formats
