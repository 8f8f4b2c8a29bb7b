//! How the ride is judged: frequency weightings and exposure measures for people in a moving vehicle.
