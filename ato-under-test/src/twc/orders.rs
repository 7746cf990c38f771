//! Orders of the wayside, checked against the track database as station data are. An order counts when it first comes:
//! the wayside repeats it for as long as the train is over the loop, and means it once.

use protocol::Instant;
use protocol::config::OrdersConfig;
use protocol::event::Event;
use protocol::line::Line;
use protocol::message::{TrainOrder, TwcOrders};

use super::{Ordered, TrainNumber, Twc};
use crate::guards::Guards;
use crate::kernel::EventLog;

/// Unit of length in frames, m.
const DECIMETRE_M: f64 = 0.1;

impl Twc {
    /// Takes orders unless they are for another train or contradict the track database; the order, if they give a new one.
    pub fn take_orders(
        &mut self,
        now: Instant,
        orders: &TwcOrders,
        own: TrainNumber,
        (line, config): (&Line, &OrdersConfig),
        guards: Guards,
        log: &mut EventLog,
    ) -> Option<TrainOrder> {
        if self.passes_over(now, orders.train_number, own, guards, log) {
            return None;
        }
        self.received = self.received.wrapping_add(1);
        let route = self.data.as_ref().map(|data| data.route);
        let refusal = contradiction(orders, route, line, config, guards);
        if let Some((event, parameter)) = refusal {
            self.refused = self.refused.wrapping_add(1);
            if self.orders_refusal != refusal {
                log.push(now, event, parameter);
            }
        }
        self.orders_refusal = refusal;
        if refusal.is_some() {
            return None;
        }
        let still = |before: &Ordered| now.since(before.heard) < self.timeout;
        let before = self.ordered.filter(still).map(|before| before.order);
        self.ordered = Some(Ordered {
            destination: orders.destination,
            order: orders.order,
            heard: now,
        });
        let given = orders.order != TrainOrder::None && before != Some(orders.order);
        given.then_some(orders.order)
    }

    /// Destination in force; 0 = none.
    pub fn destination(&self) -> u16 {
        self.ordered.map_or(0, |ordered| ordered.destination)
    }

    /// Frames for this train, refused ones of them, and frames for other trains since power-up, wrapping.
    pub fn counts(&self) -> (u16, u16, u16) {
        (self.received, self.refused, self.others)
    }
}

/// Event, with its parameter, for orders that contradict the track database. Stations are those of `route`, or of
/// any while no station data are in force.
fn contradiction(
    orders: &TwcOrders,
    route: Option<u16>,
    line: &Line,
    config: &OrdersConfig,
    guards: Guards,
) -> Option<(Event, i32)> {
    let length_m = f64::from(orders.section_length_dm) * DECIMETRE_M;
    let section = line.section(orders.section);
    let long_as_told = section.is_some_and(|section| {
        libm::fabs(section.length_m - length_m) <= config.length_tolerance_m
    });
    let on_route = line.sections.iter().any(|section| {
        let ends = [section.from_station, section.to_station];
        route.is_none_or(|route| section.route == route) && ends.contains(&orders.destination)
    });
    let compared = guards.orders;
    let length_dm = i32::try_from(orders.section_length_dm).unwrap_or(i32::MAX);
    let checks = [
        (
            compared && orders.section != 0 && !long_as_told,
            (Event::TwcWrongLength, length_dm),
        ),
        (
            compared && orders.destination != 0 && !on_route,
            (Event::TwcWrongDestination, i32::from(orders.destination)),
        ),
        (
            !orders.order.is_known(),
            (Event::TwcWrongOrder, i32::from(orders.order.code())),
        ),
    ];
    let found = checks.iter().find(|(contradicts, _)| *contradicts);
    found.map(|(_, event)| *event)
}

#[cfg(test)]
mod tests {
    use protocol::Duration;

    use super::*;
    use crate::for_tests::{line8, with};

    const OWN: TrainNumber = 8001;

    fn good(line: &Line) -> TwcOrders {
        let section = &line.sections[0];
        TwcOrders {
            train_number: OWN,
            section: section.section,
            section_length_dm: (section.length_m * 10.0) as u32,
            destination: line.sections[3].to_station,
            order: TrainOrder::None,
        }
    }

    #[test]
    fn each_wrong_number_has_its_event() {
        let line = line8();
        let good = good(line);
        let config = OrdersConfig::default();
        let long = |by_m: f64| TwcOrders {
            section_length_dm: ((line.sections[0].length_m + by_m) * 10.0) as u32,
            ..good
        };
        let cases = [
            (good, None),
            (TwcOrders::default(), None),
            (long(0.9), None),
            (long(1.2), Some(Event::TwcWrongLength)),
            (long(-1.2), Some(Event::TwcWrongLength)),
            (
                with(good, |it| it.section = 999),
                Some(Event::TwcWrongLength),
            ),
            (
                with(good, |it| it.destination = 999),
                Some(Event::TwcWrongDestination),
            ),
            (
                with(good, |it| it.order = TrainOrder::Unknown(9)),
                Some(Event::TwcWrongOrder),
            ),
        ];
        for (orders, expected) in cases {
            for route in [None, Some(line.sections[0].route)] {
                let found = contradiction(&orders, route, line, &config, Guards::ALL);
                assert_eq!(found.map(|(event, _)| event), expected, "{orders:?}");
            }
        }
        let other_route = contradiction(&good, Some(99), line, &config, Guards::ALL);
        assert!(matches!(other_route, Some((Event::TwcWrongDestination, _))));
    }

    #[test]
    fn an_order_is_given_once_for_as_long_as_it_is_sent() {
        let (line, config) = (line8(), OrdersConfig::default());
        let mut log = EventLog::default();
        let mut twc = Twc::new(Duration::from_ms(1000));
        let mut at_ms = 0;
        let mut given = |pause_ms: u64, order, train_number| {
            at_ms += pause_ms;
            let orders = TwcOrders {
                order,
                train_number,
                ..good(line)
            };
            let now = Instant::from_ms(at_ms);
            twc.take_orders(now, &orders, OWN, (line, &config), Guards::ALL, &mut log)
        };
        use TrainOrder::{None, PutAway, TurnBack, Unknown};
        let cases = [
            (0, None, OWN, Option::None),
            (250, TurnBack, 9999, Option::None),
            (250, TurnBack, OWN, Some(TurnBack)),
            (250, TurnBack, OWN, Option::None),
            (250, Unknown(9), OWN, Option::None),
            (250, TurnBack, OWN, Option::None),
            (250, PutAway, OWN, Some(PutAway)),
            (250, None, OWN, Option::None),
            (250, PutAway, OWN, Some(PutAway)),
            (1000, PutAway, OWN, Some(PutAway)),
        ];
        for (at, (pause_ms, order, number, expected)) in cases.into_iter().enumerate() {
            assert_eq!(given(pause_ms, order, number), expected, "{at}");
        }
        assert_eq!(twc.counts(), (9, 1, 1));
        assert_eq!(twc.destination(), line.sections[3].to_station);
    }
}
