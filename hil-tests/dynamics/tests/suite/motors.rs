//! Motors and their controllers: curve, lag, steps.

use flight_dynamics::Esc;

use crate::{close, fly, flying, vehicles};

#[test]
fn the_thrust_curve_bends_as_stated() {
    let mut propulsion = vehicles::quad().propulsion;
    propulsion.expo = 0.6;
    close(propulsion.thrust_share(0.5), 0.4 * 0.5 + 0.6 * 0.25, 1e-15);
    close(propulsion.thrust_share(0.0), 0.0, 0.0);
    close(propulsion.thrust_share(1.0), 1.0, 1e-15);
}

#[test]
fn after_one_time_constant_a_rotor_has_made_63_percent_of_the_way() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.propulsion.lag_up = 0.03;
    vehicle.propulsion.lag_down = 0.05;
    let (slow, fast) = (
        vehicles::speed_at(&vehicle, 0.3),
        vehicles::speed_at(&vehicle, 0.7),
    );
    let left = (-1.0_f64).exp();
    let mut drone = flying(&vehicle, 50.0, 0.3);
    fly(&mut drone, 0.03, 1e-3, &[0.7; 4]);
    close(
        drone.state().rotor_speeds[0],
        fast - (fast - slow) * left,
        1e-4,
    );
    let mut drone = flying(&vehicle, 50.0, 0.7);
    fly(&mut drone, 0.05, 1e-3, &[0.3; 4]);
    close(
        drone.state().rotor_speeds[3],
        slow + (fast - slow) * left,
        1e-4,
    );
}

#[test]
fn a_controller_of_8_bits_knows_256_throttles() {
    let esc = Esc::default();
    let mut read: Vec<u64> = (0..=100_000)
        .map(|i| (esc.reads(f64::from(i) / 100_000.0) * 255.0).round() as u64)
        .collect();
    read.dedup();
    assert_eq!(read, (0..256).collect::<Vec<_>>());
    close(esc.reads(0.5), 128.0 / 255.0, 1e-15);
    close(esc.reads(1.0), 1.0, 0.0);
}

#[test]
fn throttles_within_one_step_of_the_controller_fly_alike_and_a_step_apart_do_not() {
    let vehicle = vehicles::quad();
    let after = |throttle: f64| {
        let mut drone = flying(&vehicle, 50.0, 0.5);
        fly(&mut drone, 0.1, 1e-3, &[throttle; 4]);
        *drone.state()
    };
    let step = 1.0 / 255.0;
    assert_eq!(after(100.0 * step), after(100.3 * step));
    assert_ne!(after(100.0 * step), after(101.0 * step));
}

#[test]
fn below_the_dead_zone_motors_stand() {
    let mut vehicle = vehicles::ideal(vehicles::quad());
    vehicle.esc.dead_zone = 0.05;
    let mut drone = flying(&vehicle, 500.0, 0.0);
    fly(&mut drone, 0.2, 1e-3, &[0.049, 0.051, 0.0, 1.0]);
    let [below, above, zero, full, ..] = drone.state().rotor_speeds;
    assert_eq!((below, zero), (0.0, 0.0));
    assert!(above > 50.0 && full > 800.0);
}

#[test]
fn a_lower_coaxial_rotor_thrusts_less_at_the_same_torque() {
    let vehicle = vehicles::ideal(vehicles::y6());
    let hover = vehicles::hover(&vehicle);
    let mut drone = flying(&vehicle, 50.0, hover);
    fly(&mut drone, 0.5, 1e-3, &[hover; 6]);
    close(drone.state().rates.norm(), 0.0, 1e-9);
    let share = vehicle.propulsion.thrust_share(hover);
    let thrust = share * vehicle.propulsion.full_thrust * 3.0 * 1.8;
    close(thrust, vehicle.mass * 9.80665, 1e-9);
}
