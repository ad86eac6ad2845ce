"""Raw sonar and odometry in, distributions over ranges and pose out."""
