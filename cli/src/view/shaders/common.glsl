#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler3D;
const float PI = 3.14159265358979;
const float TAU = 6.28318530717959;
const float THETA_MAX = 89.0 / 180.0 * PI; // largest angle of the directions of a table
