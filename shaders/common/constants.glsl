#ifndef LUMIVOX_CONSTANTS
#define LUMIVOX_CONSTANTS

const float kPi = 3.14159265358979323846;
const float kGoldenAngle = 2.39996322972865332223;  // pi (3 - sqrt 5), rad

#endif
