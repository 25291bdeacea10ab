#ifndef LUMIVOX_IMAGE_FILTERS_LUMINANCE
#define LUMIVOX_IMAGE_FILTERS_LUMINANCE

float luminanceOf(vec3 light) { return dot(light, vec3(0.2126, 0.7152, 0.0722)); }  // Rec. 709

#endif
