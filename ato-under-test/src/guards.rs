//! Guards and orders of the unit that an injected fault puts out of action. All of them are here: the functions look at
//! one flag each, and know no faults.

use protocol::injection::Place;

use crate::faults::Faults;

macro_rules! guards {
    ($($(#[$doc:meta])* $name:ident: $place:ident,)*) => {
        /// Guards that work now.
        #[derive(Clone, Copy, Debug)]
        pub struct Guards {
            $($(#[$doc])* pub $name: bool,)*
        }

        impl Guards {
            pub const ALL: Self = Self { $($name: true,)* };

            pub fn of(faults: &Faults) -> Self {
                Self { $($name: !faults.dead(Place::$place),)* }
            }
        }
    };
}

guards! {
    // ATP.
    /// A stop has no margins, and an absolute stop asks for a brake.
    stop: StopGuard,
    /// Doors that open without being enabled are noticed.
    doors: DoorGuard,
    /// Door enables last until the doors are proved closed, whatever becomes of the station data.
    enable_latch: EnableLatch,
    /// An acknowledgement is compared with the emergency brake's cause.
    release: ReleaseGuard,
    /// The emergency brake is released when no wheel makes a pulse, not at a speed that counts as standing.
    release_standstill: ReleaseStandstill,
    /// Speed, way and direction of ATO's jogging are supervised.
    jog: JogGuard,
    /// A code in force is renewed only by a confirmed code.
    code_confirmation: CodeConfirmation,
    /// Motion with the reverser in neutral is noticed.
    neutral: NeutralGuard,
    /// A speed that falls faster than a train can slow is not believed.
    speed: SpeedGuard,
    /// An emergency brake line that others open is noticed.
    line: LineGuard,
    // Position.
    /// Further edges of a marker's contact are left out.
    marker_debounce: MarkerDebounce,
    /// A marker is compared with the way from the marker before.
    marker: MarkerGuard,
    /// Places without a loop are known.
    loop_places: LoopPlaces,
    // What the wayside sends.
    /// Data for another train are left out.
    train_number: TrainGuard,
    /// Station data are compared with the track database, but for the door side.
    station: StationGuard,
    /// The door side is compared with the track database.
    side: SideGuard,
    /// Destination and section length are compared with the track database.
    orders: OrderGuard,
    /// ATO runs slowly when the wayside orders it.
    slow_running: SlowRunning,
    // Entries at the cab.
    /// A train number that is keyed in is taken.
    cab_entries: CabEntries,
    /// A wheel diameter that is keyed in must be in range.
    wheel: WheelGuard,
    // Driverless operation, and departure.
    /// ATO closes doors.
    door_closing: DoorClosing,
    /// ATO opens doors again that do not close.
    door_reopening: DoorReopening,
    /// A train departs with doors proved closed.
    departure: DepartureGuard,
    /// ATO jogs to a stop point that it missed.
    jogging: Jog,
    /// A cab that is given up at a turn-back brakes.
    hand_over_brake: HandOverBrake,
    /// A train that is put away brakes.
    put_away_brake: PutAwayBrake,
    /// A train that wakes up tests itself.
    wake_up_test: WakeUpTest,
    // Test mode.
    /// Arming needs a train that stands.
    arm_standstill: ArmStandstill,
    /// Arming, and staying armed, needs applied brakes.
    arm_brakes: ArmBrakes,
    /// The train's own motion ends test mode.
    motion: MotionGuard,
    /// Another code in the rail ends test mode.
    rail_code: CodeGuard,
    /// Another position of the mode switch ends test mode.
    mode_switch: ModeGuard,
    /// Taking the maintenance key ends test mode.
    key: KeyGuard,
    /// The brakes are held while armed.
    brake_hold: BrakeHold,
    /// No powering while armed.
    traction_bar: TractionBar,
    /// No Automatic Run while armed.
    start_bar: StartBar,
    /// No door is enabled while armed.
    door_bar: DoorBar,
}
